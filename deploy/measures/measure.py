"""What a measure is, and where the binaries and the data are."""
import contextlib
import json
import os
import pathlib
import subprocess
import tempfile


class Measure:
    """`detail`: lines that tell what the value counts, for stderr and the document."""
    def __init__(self, name, value, limit, state, detail=()):
        self.name, self.value, self.limit, self.state, self.detail = name, value, limit, state, list(detail)

    def row(self):
        told = {"name": self.name, "value": self.value, "limit": self.limit, "state": self.state}
        return {**told, "detail": self.detail} if self.detail else told


def shown(value):
    return "%.6g" % value if isinstance(value, float) else str(value)


def at_most(name, value, limit, unit="", detail=()):
    return Measure(name, shown(value) + unit, "<=" + shown(limit) + unit, "ok" if value <= limit else "SHORT", detail)


def at_least(name, value, limit, unit="", detail=()):
    return Measure(name, shown(value) + unit, ">=" + shown(limit) + unit, "ok" if value >= limit else "SHORT", detail)


def within(name, value, centre, half_width, unit=""):
    limit = "%s+-%s%s" % (shown(centre), shown(half_width), unit)
    return Measure(name, shown(value) + unit, limit, "ok" if abs(value - centre) <= half_width else "SHORT")


def between(name, value, least, most, unit=""):
    limit = "%s..%s%s" % (shown(least), shown(most), unit)
    return Measure(name, shown(value) + unit, limit, "ok" if least <= value <= most else "SHORT")


def equal(name, value, wanted, detail=()):
    return Measure(name, shown(value), "==" + shown(wanted), "ok" if value == wanted else "SHORT", detail)


def info(name, value, unit="", detail=()):
    """A figure that is asked for without a limit."""
    return Measure(name, shown(value) + unit, "-", "ok", detail)


def skip(name, why):
    return Measure(name, why.replace(" ", "_"), "-", "skip")


@contextlib.contextmanager
def processors(count):
    """What is started meanwhile has so many of this machine's processors."""
    all_of_them = os.sched_getaffinity(0)
    os.sched_setaffinity(0, set(sorted(all_of_them)[:count]))
    try:
        yield
    finally:
        os.sched_setaffinity(0, all_of_them)


DEBIAN_PICTURES = pathlib.Path("/usr/share/doc/opencv-doc/examples/data")


class Context:
    def __init__(self, full, counted=False):
        self.full, self.counted = full, counted
        self.root = pathlib.Path(__file__).resolve().parent.parent.parent
        self.bin = self.root / "build" / "release" / "bin"
        self.data = self.root.parent / "shared" / "data"

    def stereo_pairs(self):
        """The folder of left01.jpg ... right14.jpg: of the recordings, or the same files of Debian's opencv-doc. May not be there."""
        recorded = self.data / "stereo_opencv"
        return recorded if recorded.is_dir() else DEBIAN_PICTURES

    def built(self):
        return all((self.bin / name).exists() for name in ("rigcald", "rigcal", "graph_bench", "stereo_measure"))

    def run_json(self, program, *arguments, timeout=600, env=None):
        """Runs a binary of ours and reads the JSON that it prints."""
        done = subprocess.run([str(self.bin / program), *map(str, arguments)], capture_output=True, text=True, timeout=timeout, env=env)
        if done.returncode not in (0, 1):
            raise RuntimeError("%s %s: exit %d: %s" % (program, " ".join(map(str, arguments)), done.returncode, done.stderr.strip()[-300:]))
        return json.loads(done.stdout)

    def folder(self):
        """A temporary folder on the disk of the build, so that fsync is real."""
        place = self.root / "build" / "measure"
        place.mkdir(parents=True, exist_ok=True)
        return tempfile.TemporaryDirectory(dir=place)
