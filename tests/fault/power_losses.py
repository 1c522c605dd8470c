"""Power losses at chosen points of a recording, and what each of them breaks."""
import pathlib
import random

from crashed_disk import Chance, Disk, Everything, Nothing
from disk_record import MARK, SYNC, SYNC_DISK
from promises import Facts, Promised


class Judge:
    """Looks at each different disk once."""

    def __init__(self, records, programs, place):
        self.records, self.programs, self.place = records, pathlib.Path(programs), place
        self.facts = {}
        disk = Disk()
        for record in records:
            if record.act == MARK and record.path.startswith("damaged"):
                break  # on purpose: published reports share the file
            disk.apply(record)
        self.final = disk.after_power_loss(Everything)

    def facts_of(self, found):
        key = hash(frozenset((path, hash(content)) for path, content in found.items() if path.startswith("store")))
        if key not in self.facts:
            self.facts[key] = Facts(found, self.programs, self.place)
        return self.facts[key]

    def losses(self, points, fate_of, is_ignored=lambda _record: False):
        """(point, sentences) of each point, in their order: so many records were done when the power went."""
        disk, promised, wanted = Disk(), Promised(), sorted(set(points))
        for number, record in enumerate(self.records, 1):
            disk.apply(record, record.act in (SYNC, SYNC_DISK) and is_ignored(record))
            if record.act == MARK:
                promised.hear(record.path, disk)
            if wanted and wanted[0] == number:
                found = disk.after_power_loss(fate_of(wanted.pop(0)))
                yield number, list(promised.broken_by(found, self.facts_of(found), self.final))

    def telling_points(self):
        """After everything that was told, and whenever more became durable."""
        return [number for number, record in enumerate(self.records, 1) if record.act in (MARK, SYNC, SYNC_DISK)] + [len(self.records)]


def nothing(_point):
    return Nothing


def by_chance(seed):
    return lambda point: Chance(random.Random(seed * 1_000_003 + point))
