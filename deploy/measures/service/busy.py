"""Robots that push sessions without a pause: work is always waiting for each of them, and each must still be revised."""
import datetime
import json
import pathlib
import subprocess
import time
import urllib.request

from ..measure import at_least, at_most, info
from ..server import ANSWERED, Server
from .pushing import Pushing

ROBOTS = ("busy-1", "busy-2")


class Visits(Pushing):
    """One robot's sessions, one after the other, until it is left."""

    def __init__(self, context, server, folder, robot, seed):
        super().__init__(server)
        self.context, self.folder, self.robot, self.seed = context, folder, robot, seed

    def push_next(self):
        self.pushed += 1
        session = self.folder / ("%s-%d" % (self.robot, self.pushed))
        at = datetime.datetime(2026, 1, 1) + datetime.timedelta(days=self.pushed)
        made = subprocess.run([str(self.context.bin / "rigcal"), "simulate", "mars-mapper", "--out", str(session), "--captures", "10", "--scale", "0.3",
                               "--seed", str(self.seed + self.pushed), "--captured-at", at.strftime("%Y-%m-%dT%H:%M:%SZ"), "--threads", "1"],
                              capture_output=True, text=True)
        if made.returncode != 0:
            return made.stderr
        yaml = session / "session.yaml"
        yaml.write_text(yaml.read_text().replace("robot: mars-mapper", "robot: " + self.robot))
        return self.refusal_of("push", session, "--no-wait")


def stamp(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00")).timestamp()


def gaps(server, robot, first_edge_at, until):
    """Seconds that new edges of the robot were in no revision, at the most."""
    with urllib.request.urlopen(server.address + "/api/v1/revisions?robot=" + robot, timeout=60) as reply:
        revised_at = sorted(stamp(one["created_at"]) for one in json.load(reply)["revisions"])
    times = [first_edge_at] + [at for at in revised_at if at < until] + [until]
    return max(b - a for a, b in zip(times, times[1:])), len(revised_at)


def first_edge(server, robot, patience_s):
    """When the robot's first edge was there."""
    until = time.time() + patience_s
    while time.time() < until:
        done = server.rigcal("edges", robot, "--json")
        if done.returncode in ANSWERED and json.loads(done.stdout)["edges"]:
            return time.time()
    raise RuntimeError("no edge of %s came" % robot)


def run(context):
    seconds = 600 if context.full else 150
    with context.folder() as name:
        folder = pathlib.Path(name)
        with Server(context, folder / "data") as server:
            with Visits(context, server, folder, ROBOTS[0], 1000) as one, Visits(context, server, folder, ROBOTS[1], 2000) as two:
                began = {robot: first_edge(server, robot, 120) for robot in ROBOTS}
                one.stopped.wait(timeout=seconds)
                until = time.time()
                waiting = {robot: json.loads(server.rigcal("sessions", robot, "--json").stdout)["sessions"] for robot in ROBOTS}
                for robot in ROBOTS:
                    longest_s, revisions = gaps(server, robot, began[robot], until)
                    yield at_most("longest_without_revision_" + robot, longest_s, 60.0, "s")
                    yield info("revisions_" + robot, revisions)
                    jobs = sum(one["jobs_waiting"] for one in waiting[robot])
                    yield at_least("work_waiting_at_the_end_" + robot, jobs, 1)
                pushed = one.pushed + two.pushed
            yield info("sessions_pushed", pushed)
