"""Allocations of a serving rigcald and of the processes that work for it fail, alone and in a row: each time one
sentence at the most, the server lives, and pushing and asking again gives everything.

usage: no_memory_test.py [--rounds N] [--seed N] [--json]
"""
import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from power_scene import TRIANGLE  # noqa: E402  first: it says where the rest is
from disk_record import Plan  # noqa: E402
from edge_case import edge  # noqa: E402
from measures.server import ANSWERED, Server  # noqa: E402
from measures.sessions import noise_session  # noqa: E402
from power_loss_test import context_of  # noqa: E402

PAGES = ["/", "/api/v1/robots", "/metrics", "/api/v1/health"]
# How many allocations come to pass before the first that fails, and how many fail in a row.
LATEST = {"memory": 20000, "large": 40}
ROWS = [1, 19, 25, 40, 60]


class ShortServer(Server):
    def __init__(self, context, folder):
        super().__init__(context, folder / "store")
        self.plan = Plan(folder / "plan")

    def environment(self):
        return {**super().environment(), "LD_PRELOAD": str(self.context.bin / "librigcal_failing_memory.so"), "RIGCAL_FAULT_PLAN": str(self.plan.file)}


class Test:
    def __init__(self, context, folder):
        self.folder, self.failures = folder, []
        self.server = ShortServer(context, folder)
        self.rows = self.refused = self.unanswered = 0

    def check(self, good, what):
        if not good:
            self.failures.append(what)
            print(what, file=sys.stderr, flush=True)

    def client(self, *verb):
        """Nothing fails in it."""
        return subprocess.run(self.server.client(*verb), env=Server.environment(self.server), capture_output=True, text=True, timeout=200)

    def act(self, robot):
        edges, session = self.folder / "edges.json", self.folder / robot
        edges.write_text(json.dumps({"format": 1, "edges": [edge(a, b, x) for a, b, x in TRIANGLE]}))
        if not session.exists():
            noise_session(session, robot + "-seen", 3000, 2, seed=robot)
        return [self.client(*verb) for verb in (("push", session, "--no-wait"), ("push-edges", edges, "--robot", robot), ("robots",))]

    def page(self, path):
        """Its status; None: the connection was closed."""
        try:
            with urllib.request.urlopen(self.server.address + path, timeout=60) as reply:
                reply.read()
                return reply.status
        except urllib.error.HTTPError as error:
            return error.code
        except OSError:
            return None

    def goes_without(self, kind, at, row):
        name, robot = "%s %d, %d in a row" % (kind, at, row), "%s-%d-%d" % (kind, at, row)
        self.server.plan.fail(kind, at, row)
        done = self.act(robot)
        pages = [self.page(path) for path in PAGES]
        self.rows += self.server.plan.end()
        for one in done:
            if one.returncode not in ANSWERED:
                self.refused += 1
                self.check(len(one.stderr.strip().splitlines()) == 1, "%s: not one sentence: %r" % (name, one.stderr))
        self.unanswered += sum(status != 200 for status in pages)
        if self.server.process.poll() is not None:
            self.check(False, "%s: the server ended with %d" % (name, self.server.process.returncode))
            self.server.close()
            self.server.start().wait_ready()
        for again in self.act(robot):
            self.check(again.returncode in ANSWERED, "%s: again: exit %d: %s" % (name, again.returncode, again.stderr))
        for path in PAGES:
            self.check(self.page(path) == 200, "%s: %s is not answered" % (name, path))

    def run(self, rounds, seed):
        draw = random.Random(seed)
        with self.server:
            self.act("before")
            for number in range(rounds):
                kind = "large" if number % 4 == 3 else "memory"
                self.goes_without(kind, int(LATEST[kind] ** draw.random()), draw.choice(ROWS))
            self.wait_ready_again()
        self.check(self.rows > 0, "no allocation failed: is librigcal_failing_memory.so built?")
        checked = self.client("fsck", self.server.data)
        self.check(checked.returncode == 0, "fsck: exit %d: %s" % (checked.returncode, checked.stdout[-400:]))

    def wait_ready_again(self, patience_s=60):
        until = time.monotonic() + patience_s
        while self.page("/readyz") != 200:
            if time.monotonic() > until:
                return self.check(False, "/readyz is not 200 again")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    memory = pathlib.Path("/dev/shm")
    with tempfile.TemporaryDirectory(prefix="rigcal-memory-", dir=memory if os.access(memory, os.W_OK) else None) as temporary:
        test = Test(context_of(), pathlib.Path(temporary))
        test.run(options.rounds, options.seed)
    told = {"rows": test.rows, "refused": test.refused, "unanswered": test.unanswered, "failures": test.failures}
    text = "%d rows of allocations failed, %d commands were refused, %d pages not answered" % (test.rows, test.refused, test.unanswered)
    print(json.dumps(told) if options.json else "\n".join([text, *test.failures]))
    return 1 if test.failures else 0


if __name__ == "__main__":
    sys.exit(main())
