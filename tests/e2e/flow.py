"""Where the binaries are, a server in a temporary folder, and checks with words."""
import json
import os
import pathlib
import sys
import tempfile
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "deploy"))
from measures.measure import Context  # noqa: E402
from measures.server import ANSWERED, Server  # noqa: E402,F401

SKIPPED = 77
NOT_FAILED = (0, 5, 6)  # how a verb ends that told a verdict other than fail
TELLING = ("push", "push-edges", "show", "lookup", "restore", "retire", "status")


class Flow:
    """A temporary folder and a server in it that can be killed and started again. `arguments`: of rigcald."""

    def __init__(self, *arguments):
        self.arguments = arguments
        self.context = Context(full=False)
        self.context.bin = pathlib.Path(os.environ["RIGCAL_BIN"])
        self.temporary = tempfile.TemporaryDirectory(prefix="rigcal-e2e-")
        self.folder = pathlib.Path(self.temporary.name)
        self.server = Server(self.context, self.folder / "store")

    def __enter__(self):
        self.server.start(*self.arguments)
        try:
            self.address = self.ready()
        except BaseException:
            self.server.kill()
            raise
        return self

    def __exit__(self, *_):
        self.server.stop()
        self.temporary.cleanup()

    def ready(self):
        line = self.server.process.stdout.readline()
        check("ready" in line, "rigcald is ready: " + line)
        return [word for word in line.split() if word.startswith(("http://", "https://"))][0].rstrip("/")

    def kill_and_restart(self):
        self.server.kill()
        self.server.start(*self.arguments)
        self.address = self.ready()

    def get(self, path):
        with urllib.request.urlopen(self.address + path, timeout=20) as reply:
            return reply.read().decode()

    def rigcal(self, *arguments, exit_code=None):
        """`exit_code`: the one that is expected; without it 0, or any verdict but fail."""
        done = self.server.rigcal(*arguments)
        wanted = (exit_code,) if exit_code is not None else NOT_FAILED if arguments[0] in TELLING else (0,)
        check(done.returncode in wanted, "rigcal %s: exit %d instead of %r: %s%s" % (
            " ".join(map(str, arguments)), done.returncode, wanted, done.stdout, done.stderr))
        check("Traceback" not in done.stderr and "terminate called" not in done.stderr, "no stack trace: " + done.stderr)
        return done


def check(condition, what):
    if not condition:
        raise SystemExit("FAILED: " + what)


def wait_published(flow):
    """Asks, as the pages do, until nothing is left to be solved or published."""
    until = time.monotonic() + 120
    while time.monotonic() < until:
        if json.loads(flow.get("/api/v1/live"))["unfinished"] == 0:
            return
    check(False, "everything is published")


def skip_without(path):
    if not path.exists():
        print("SKIPPED: no " + path.name + " in ../shared/data")
        raise SystemExit(SKIPPED)


def stereo_pairs(context):
    folder = context.stereo_pairs()
    if not (folder / "left01.jpg").exists():
        print("SKIPPED: no stereo pairs: neither in %s (package opencv-doc) nor in ../shared/data" % folder)
        raise SystemExit(SKIPPED)
    return folder
