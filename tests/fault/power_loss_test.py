"""Power losses, simulated: what was told is there, and without any one of our syncs it would not be.

usage: power_loss_test.py [--chances N] [--recovered N] [--json]
"""
import argparse
import json
import os
import pathlib
import random
import re
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from power_scene import ROOT, Scene  # noqa: E402  first: it says where the rest is
from after_loss import end_of  # noqa: E402
from api_scene import ApiScene  # noqa: E402
from crashed_disk import Disk, Everything  # noqa: E402
from disk_record import SYNC, SYNC_DISK  # noqa: E402
from measures.measure import Context  # noqa: E402
from power_losses import Judge, by_chance, nothing  # noqa: E402
from sync_sites import Finder  # noqa: E402

SKIPPED = 77
WITHIN = {"server/base/files/durable_file.cc": 1, "storage/upkeep/copy_verified.cc": 1}  # the calls in SyncFile, SyncFolder, SyncFileSystem
CALLS = re.compile(r"(?<![\w:.])(?:::)?(?:fsync|fdatasync|syncfs|SyncFile|SyncFolder|SyncFileSystem)\((?!const )")


def calls_in_sources():
    """Source -> statements that sync."""
    found = {}
    for folder in ("server", "storage", "client"):
        for path in sorted((ROOT / folder).rglob("*.cc")):
            code = "\n".join(line.split("//")[0] for line in path.read_text().splitlines())
            source = path.relative_to(ROOT).as_posix()
            found[source] = len(CALLS.findall(code)) - WITHIN.get(source, 0)
    return found


class Test:
    def __init__(self, context, place):
        self.context, self.place, self.failures = context, place, []
        self.finder = Finder(context.bin)
        self.scenes = [Scene(context, place / "power").record(), ApiScene(context, place / "api").record()]
        self.judges = [Judge(scene.recording.records(), context.bin, place) for scene in self.scenes]

    def check(self, good, what):
        if not good:
            self.failures.append(what)

    def recordings_are_whole(self):
        """What was done, done again, gives what is there: nothing went past the recorder."""
        for scene in self.scenes:
            disk, root = Disk(), scene.recording.root
            for record in scene.recording.records():
                disk.apply(record)
            real = {path.relative_to(root).as_posix(): None if path.is_dir() else path.read_bytes()
                    for path in root.rglob("*") if not path.name.endswith("-shm")}
            self.check(real == disk.after_power_loss(Everything), "the record of %s is not whole" % root)

    def lost(self, judge, points, fate, is_ignored=lambda _record: False):
        """The first point at which something is broken, with what; None: nothing is."""
        return next(((point, broken) for point, broken in judge.losses(points, fate, is_ignored) if broken), None)

    def nothing_is_lost(self, chances):
        """The number of power losses."""
        count = 0
        for number, judge in enumerate(self.judges):
            points = judge.telling_points()
            lost = self.lost(judge, points, nothing)
            self.check(lost is None, "with whatever was not synced dropped: %r" % (lost,))
            draw, some = random.Random(number), chances if number == 0 else chances // 10
            drawn = draw.sample(range(1, len(judge.records) + 1), min(some, len(judge.records)))
            lost = self.lost(judge, drawn, by_chance(1))
            self.check(lost is None, "by chance: %r" % (lost,))
            count += len(set(points)) + len(drawn)
        return count

    def every_sync_counts(self):
        """(caught, listed): a loss is seen when the statement does nothing."""
        caught = 0
        for site in self.finder.sites:
            ignores = lambda record, site=site: self.finder.site_of(record) is site
            seen = [judge for judge in self.judges if any(ignores(record) for record in judge.records if record.act in (SYNC, SYNC_DISK))]
            self.check(seen, "nothing was recorded of: " + site.name)
            found = any(self.lost(judge, judge.telling_points(), nothing, ignores) for judge in seen)
            self.check(found or not seen, "without it nothing is lost: %s" % site.name)
            caught += found
        return caught, len(self.finder.sites)

    def every_sync_is_listed(self):
        listed = {}
        for site in self.finder.sites:
            listed[site.source] = listed.get(site.source, 0) + 1
        for judge in self.judges:
            syncs = [record for record in judge.records if record.act in (SYNC, SYNC_DISK)]
            unknown = [record for record in syncs if self.finder.is_ours(record) and not self.finder.site_of(record)]
            self.check(not unknown, "%d syncs have no line in syncs.txt, the first by %s" % (len(unknown), unknown and self.finder.chain(unknown[0])[:4]))
        for source, count in calls_in_sources().items():
            self.check(listed.get(source, 0) == count, "%s has %d statements that sync, syncs.txt %d" % (source, count, listed.get(source, 0)))

    def ends_as_quiet(self, count):
        scene, judge = self.scenes[0], self.judges[0]
        quiet = end_of(scene, place=self.place)
        draw = random.Random(2)
        for point in sorted(draw.sample(range(1, len(judge.records) + 1), count)):
            disk = Disk()
            for record in judge.records[:point]:
                disk.apply(record)
            end = end_of(scene, disk.after_power_loss(by_chance(3)(point)), self.place)
            self.check(end == quiet, "after a power loss at %d the end is another: %s" % (point, difference(quiet, end)))


def difference(quiet, end):
    return [key for key in quiet if quiet[key] != end[key]], {key: (quiet[key], end[key]) for key in ("rows",) if quiet[key] != end[key]}


def context_of():
    context = Context(full=False)
    context.bin = pathlib.Path(os.environ.get("RIGCAL_BIN", context.bin))
    return context


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chances", type=int, default=40)
    parser.add_argument("--recovered", type=int, default=2)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    context = context_of()
    if not (context.stereo_pairs() / "left01.jpg").exists():
        print("SKIPPED: no stereo pairs (package opencv-doc)")
        return SKIPPED
    memory = pathlib.Path("/dev/shm")
    with tempfile.TemporaryDirectory(prefix="rigcal-power-", dir=memory if os.access(memory, os.W_OK) else None) as temporary:
        test = Test(context, pathlib.Path(temporary))
        test.recordings_are_whole()
        test.every_sync_is_listed()
        losses = test.nothing_is_lost(options.chances)
        caught, listed = test.every_sync_counts()
        test.ends_as_quiet(options.recovered)
    told = {"losses": losses, "recovered": options.recovered, "caught": caught, "listed": listed, "failures": test.failures}
    print(json.dumps(told) if options.json else "\n".join(["%d power losses, %d of %d syncs count" % (losses, caught, listed), *test.failures]))
    return 1 if test.failures else 0


if __name__ == "__main__":
    sys.exit(main())
