"""The record that librigcal_disk_recorder.so makes of what programs do to the files below a folder (disk_log.h)."""
import dataclasses
import fcntl
import os
import pathlib
import struct

HEAD = struct.Struct("<IIIIQq")
CREATE, WRITE, TRUNCATE, RENAME, LINK, REMOVE, MAKE_FOLDER, SYNC, SYNC_DISK, MARK = range(1, 11)


@dataclasses.dataclass(frozen=True)
class Record:
    act: int
    path: str
    other: str
    data: bytes
    inode: int
    offset: int


class Plan:
    """Which operation of recorded programs is to fail (planned_failure.h), also of those that run already."""
    LAYOUT = struct.Struct("<8sqqq")

    def __init__(self, file):
        self.file = pathlib.Path(file)
        self.file.write_bytes(bytes(self.LAYOUT.size))

    def fail(self, kind, at, error):
        """The `at`-th from now on; error 0: the process dies there. Of memory, `error` of them from the `at`-th on."""
        self.write(self.LAYOUT.pack(kind.encode(), at, error, 0))

    def end(self):
        """Whether it came to that."""
        _kind, at, _error, count = self.LAYOUT.unpack(self.file.read_bytes())
        self.write(bytes(self.LAYOUT.size))
        return 0 < at <= count

    def write(self, content):
        with open(self.file, "r+b", buffering=0) as file:
            file.write(content)


class Recording:
    """Programs that run in `environment()` are recorded; all that changes below `root` from then on."""

    def __init__(self, library, root, log):
        self.library, self.root, self.log = pathlib.Path(library), pathlib.Path(root), pathlib.Path(log)
        self.root.mkdir(parents=True, exist_ok=True)
        self.plan = Plan(self.log.with_name("plan"))

    def environment(self):
        return {"LD_PRELOAD": str(self.library), "RIGCAL_FAULT_ROOT": str(self.root), "RIGCAL_FAULT_LOG": str(self.log),
                "RIGCAL_FAULT_PLAN": str(self.plan.file)}

    def mark(self, text):
        """A promise that a program made by its exit or its answer; it was made after all that is recorded so far."""
        told = text.encode()
        with open(self.log, "ab", buffering=0) as log:
            fcntl.flock(log, fcntl.LOCK_EX)
            log.write(HEAD.pack(MARK, len(told), 0, 0, 0, 0) + told)

    def records(self):
        return list(read(self.log, self.root)) if self.log.exists() else []


def read(log, root):
    """The records in order; paths are relative to the root."""
    content, at, above = pathlib.Path(log).read_bytes(), 0, str(root) + os.sep
    while at + HEAD.size <= len(content):
        act, path, other, data, inode, offset = HEAD.unpack_from(content, at)
        begin, at = at + HEAD.size, at + HEAD.size + path + other + data
        if at > len(content):
            return  # its writer was killed
        texts = [content[begin:begin + path].decode(), content[begin + path:begin + path + other].decode()]
        paths = [text.removeprefix(above).removesuffix(" (deleted)") for text in texts]
        yield Record(act, *paths, content[begin + path + other:at], inode, offset)
