"""The n-th write, sync, rename, change of names and open of a serving rigcald fails, for n = 1, 2, 3, ... until all passes:
each time one sentence, the server lives, nothing that was told is lost, and pushing again gives everything.

usage: nth_failure_test.py [--all] [--kinds KIND...] [--json]
"""
import argparse
import errno
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from power_scene import RecordedServer, TRIANGLE  # noqa: E402  first: it says where the rest is
from disk_record import MARK, Recording  # noqa: E402
from edge_case import edge  # noqa: E402
from measures.server import ANSWERED, Server  # noqa: E402
from measures.sessions import noise_session  # noqa: E402
from power_loss_test import context_of  # noqa: E402
from promises import Facts, Promised  # noqa: E402

KINDS = {"write": errno.ENOSPC, "sync": errno.EIO, "rename": errno.EIO, "change": errno.ENOSPC, "open": errno.EIO}
FIRST, MOST = 3, 5000  # of each kind in the suite; an act that needs more is one that never passes


class Test:
    def __init__(self, context, folder):
        self.context, self.folder, self.failures = context, folder, []
        self.recording = Recording(context.bin / "librigcal_disk_recorder.so", folder / "disk", folder / "record")
        self.server = RecordedServer(context, self.recording)
        self.count = self.refused = 0

    def check(self, good, what):
        if not good:
            self.failures.append(what)
            print(what, file=sys.stderr, flush=True)  # at once: all of them take long

    def push(self, robot):
        """A session and edges; how both ended. Nothing fails in the client."""
        edges, session = self.folder / "edges.json", self.folder / robot
        edges.write_text(json.dumps({"format": 1, "edges": [edge(a, b, x) for a, b, x in TRIANGLE]}))
        if not session.exists():
            noise_session(session, robot + "-seen", 3000, 2, seed=robot)
        return [subprocess.run(self.server.client(*verb), env=Server.environment(self.server), capture_output=True, text=True, timeout=120)
                for verb in (("push", session, "--no-wait"), ("push-edges", edges, "--robot", robot))]

    def fails(self, kind, at):
        """False: the act needs fewer operations of the kind."""
        robot, name = "%s-%d" % (kind, at), "%s number %d" % (kind, at)
        self.recording.plan.fail(kind, at, KINDS[kind])
        first = self.push(robot)
        failed = self.recording.plan.end()
        self.count += failed
        for done in first:
            if done.returncode not in ANSWERED:
                self.refused += 1
                self.check(len(done.stderr.strip().splitlines()) == 1, "%s: not one sentence: %r" % (name, done.stderr))
        if self.server.process.poll() is not None:
            self.check(False, "%s: the server ended with %d" % (name, self.server.process.returncode))
            self.server.close()
            self.server.serve()
        for again in self.push(robot):
            self.check(again.returncode in ANSWERED, "%s: pushing again: exit %d: %s" % (name, again.returncode, again.stderr))
        return failed

    def goes_on(self):
        """It is ready, or says why not."""
        try:
            with urllib.request.urlopen(self.server.address + "/readyz", timeout=20) as reply:
                return reply.status == 200
        except urllib.error.HTTPError as error:
            told = error.read().decode()
            print("readyz: " + told)
            return bool(told.strip())

    def numbers(self, kind, whole):
        """1, 2, 3, ...; without `whole` the first ones, and some that are drawn."""
        if whole:
            return range(1, MOST)
        return [*range(1, FIRST + 1), *sorted(random.Random(kind).sample(range(FIRST + 1, 30), FIRST))]

    def run(self, kinds, whole):
        with self.server:
            self.push("before")
            for kind in kinds:
                for at in self.numbers(kind, whole):
                    if not self.fails(kind, at):
                        break
                else:
                    self.check(not whole, "%s: it never passes" % kind)
                self.check(self.goes_on(), "%s: /readyz says nothing" % kind)
        self.nothing_told_is_lost()

    def nothing_told_is_lost(self):
        promised = Promised()
        for record in self.recording.records():
            if record.act == MARK:
                promised.hear(record.path, None)
        root = self.recording.root
        found = {path.relative_to(root).as_posix(): None if path.is_dir() else path.read_bytes() for path in root.rglob("*")}
        for sentence in promised.broken_by(found, Facts(found, self.context.bin, self.folder), found):
            self.check(False, sentence)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--kinds", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    memory = pathlib.Path("/dev/shm")
    with tempfile.TemporaryDirectory(prefix="rigcal-nth-", dir=memory if os.access(memory, os.W_OK) else None) as temporary:
        test = Test(context_of(), pathlib.Path(temporary))
        test.run(options.kinds, options.all)
    told = {"failed": test.count, "refused": test.refused, "failures": test.failures}
    print(json.dumps(told) if options.json else "\n".join(["%d operations failed, %d pushes were refused" % (test.count, test.refused), *test.failures]))
    return 1 if test.failures else 0


if __name__ == "__main__":
    sys.exit(main())
