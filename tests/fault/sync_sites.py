"""Which statement of ours asked for a sync: by the functions that the return addresses of a record lie in."""
import bisect
import functools
import pathlib
import re
import struct
import subprocess

from disk_record import SYNC_DISK

OURS = re.compile(r"SyncFile|SyncFolder|WriteDurably|MarkOpen|MakeFolderDurably|SyncSumming|PageSums::Sync|McapWriter")  # what SQLite does by itself has none of them
LIST = pathlib.Path(__file__).with_name("syncs.txt")


class Site:
    """A line of syncs.txt."""

    def __init__(self, line):
        self.source, self.function, self.kind, self.loss = (part.strip() for part in line.split("|"))
        self.name = "%s, %s of %s" % (self.source, self.kind, self.function)
        self.function, _, self.path = self.function.partition(" at ")

    def matches(self, kind, function, path):
        return kind == self.kind and self.path in path and any(
            re.search(r"(?<!\w)%s\b" % re.escape(one), function) for one in self.function.split(" or "))


def sites():
    """The innermost function that matches says which it is."""
    return [Site(line) for line in LIST.read_text().splitlines() if line and not line.startswith("#")]


@functools.lru_cache(maxsize=None)
def functions_of(program):
    """Sorted (address, name) of the program's own functions."""
    lines = subprocess.run(["nm", "-C", "--defined-only", str(program)], capture_output=True, text=True, check=True).stdout.splitlines()
    rows = [line.split(" ", 2) for line in lines]
    return sorted((int(row[0], 16), row[2]) for row in rows if len(row) == 3 and row[1] in "tTwW")


class Finder:
    def __init__(self, programs):
        self.programs, self.sites = pathlib.Path(programs), sites()
        self.known = {}

    def kind(self, record):
        if record.act == SYNC_DISK:
            return "disk"
        return "folder" if record.offset == 1 else "file"

    def chain(self, record):
        """Names of functions, the innermost first."""
        functions = functions_of(self.programs / record.other)
        starts = [address for address, _ in functions]
        addresses = struct.unpack("<%dQ" % (len(record.data) // 8), record.data)
        return [functions[bisect.bisect_right(starts, address - 1) - 1][1] for address in addresses]

    def is_ours(self, record):
        return (self.programs / record.other).exists() and any(OURS.search(name) for name in self.chain(record))

    def site_of(self, record):
        """None: it has no line."""
        key = (record.other, record.data, self.kind(record), record.path)
        if key not in self.known:
            chain = self.chain(record) if (self.programs / record.other).exists() else []
            if not any(OURS.search(name) for name in chain):
                chain = [pathlib.Path(record.path).suffix]
            found = (site for name in chain for site in self.sites if site.matches(key[2], name, record.path))
            self.known[key] = next(found, None)
        return self.known[key]
