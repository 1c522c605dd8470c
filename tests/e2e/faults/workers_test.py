"""Several processes calibrate for one server: one is killed amid its work, one stands still beyond its lease and wakes. The others
finish, what the stalled one does is refused, and every id and digest is that of a quiet server with a store of its own."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from flow import ROOT, Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOTS = ("rig-1", "rig-2", "rig-3")
WAIT_MAX_S = 120  # how soon it comes, `deploy/measure workers` tells


def sessions(flow):
    for number, robot in enumerate(ROBOTS, 1):
        flow.rigcal("simulate", front_rig(flow, robot, robot), "--out", flow.folder / robot, "--seed", number, "--captures", 10, "--scale", 0.25,
                    "--captured-at", "2026-01-31T10:00:00Z")


def push(flow):
    return [subprocess.Popen(flow.server.client("push", flow.folder / robot), env=flow.server.environment(), stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True) for robot in ROBOTS]


def await_pushed(pushes):
    for one in pushes:
        said, _ = one.communicate(timeout=240)
        check(one.returncode in (0, 5, 6), "a push ended with %d: %s" % (one.returncode, said))


def told(flow):
    wait_published(flow)
    answers = {}
    for robot in ROBOTS:
        shown = json.loads(flow.rigcal("show", robot, "--json").stdout)
        answers[robot] = (shown["digest"], [one["id"] for one in json.loads(flow.rigcal("edges", robot, "--json").stdout)["edges"]])
    return answers


def on_sqlite():
    with Flow() as flow:
        sessions(flow)
        await_pushed(push(flow))
        return told(flow)


class Worker:
    """A rigcal-worker with the processes that it starts, in a group of its own."""

    def __init__(self, flow, number):
        self.log = flow.folder / ("worker-%d.log" % number)
        self.process = subprocess.Popen([str(flow.context.bin / "rigcal-worker"), "--data", str(flow.folder / "store"), "--threads", "1"],
                                        stdout=subprocess.PIPE, stderr=open(self.log, "w"), text=True, start_new_session=True)
        line = self.process.stdout.readline()
        check("works as" in line, "a worker is ready: " + line + self.log.read_text())
        self.name = line.split(" works as ")[1].split(": ")[0]

    def tell(self, what):
        os.killpg(self.process.pid, what)

    def stop(self):
        if self.process.poll() is None:
            self.tell(signal.SIGCONT)
            self.process.terminate()
            self.process.wait(timeout=60)


def query(sql):
    return subprocess.run(["psql", "--quiet", "--no-psqlrc", "--tuples-only", "--no-align", os.environ["RIGCAL_STORE"], "--command", sql], check=True,
                          capture_output=True, text=True).stdout.split("\n")[:-1]


def wait_until(what, holds, seconds):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if holds():
            return
        query("SELECT 1")  # however fast the database answers
    check(False, what)


def job_under_way(owner):
    """The robot of which `owner` has a job under way."""
    rows = query("SELECT l.robot_id FROM rigcal.lease_robot l JOIN rigcal.waiting_job j ON j.robot_id = l.robot_id JOIN rigcal.waiting_attempt a ON "
                 "a.work = 'job ' || j.job_number WHERE l.owner = '%s' AND a.open_number IS NOT NULL" % owner)
    return rows[0] if rows else None


def amid_a_job(worker):
    wait_until("%s has a job" % worker.name, lambda: job_under_way(worker.name), WAIT_MAX_S)


def stop_amid_a_job(worker):
    """Stands still with a job that it has not told the end of: not one of which the database has that already."""
    while True:
        amid_a_job(worker)
        worker.tell(signal.SIGSTOP)
        if all(job_under_way(worker.name) for _ in range(3)):
            return
        worker.tell(signal.SIGCONT)


def with_workers(flow):
    workers = [Worker(flow, number) for number in range(3)]
    try:
        pushes = push(flow)
        killed, stalled, left = workers
        amid_a_job(killed)
        killed.tell(signal.SIGKILL)
        ended = time.monotonic()
        stop_amid_a_job(stalled)
        wait_until("nobody holds what the killed one held", lambda: not query(
            "SELECT 1 FROM rigcal.lease_robot WHERE owner = '%s'" % killed.name) or not query("SELECT 1 FROM rigcal.waiting_job"), WAIT_MAX_S)
        print("taken over %.1f s after the kill" % (time.monotonic() - ended))
        wait_until("another has what the stalled one held", lambda: not query("SELECT 1 FROM rigcal.lease_robot WHERE owner = '%s'" % stalled.name), WAIT_MAX_S)
        await_pushed(pushes)
        answers = told(flow)
        before = query("SELECT count(*) FROM rigcal.edge")
        stalled.tell(signal.SIGCONT)
        wait_until("the stalled one is refused", lambda: "another process took over robot" in stalled.log.read_text(), WAIT_MAX_S)
        check(told(flow) == answers and query("SELECT count(*) FROM rigcal.edge") == before, "what woke changed nothing")
        check("taken over from" in left.log.read_text(), "who took over says so: " + left.log.read_text())
        return answers
    finally:
        for worker in workers:
            worker.stop()


def on_postgres():
    server = os.environ["RIGCAL_TEST_POSTGRES"], os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]
    subprocess.run(["psql", "--quiet", "--no-psqlrc", server[0] + "postgres" + server[1], "--command", "CREATE DATABASE shared"], check=True)
    os.environ["RIGCAL_STORE"] = server[0] + "shared" + server[1]
    try:
        with Flow("--threads", "0") as flow:
            wrong_folder(flow)
            sessions(flow)
            return with_workers(flow)
    finally:
        del os.environ["RIGCAL_STORE"]


def refusals(folder):
    """What cannot be is one sentence."""
    binaries = pathlib.Path(os.environ["RIGCAL_BIN"])
    for arguments, word in ((["rigcal-worker", "--data", folder], "one process"), (["rigcald", "--data", folder, "--threads", "0", "--http", "127.0.0.1:0"],
                                                                                    "nobody would calibrate")):
        done = subprocess.run([str(binaries / arguments[0])] + arguments[1:], capture_output=True, text=True, timeout=60)
        check(done.returncode != 0 and word in done.stderr and done.stderr.count("\n") == 1, "%s is refused in a sentence: %s" % (arguments[0], done.stderr))


def wrong_folder(flow):
    """A worker with a folder of its own would take every file for lost."""
    done = subprocess.run([str(flow.context.bin / "rigcal-worker"), "--data", str(flow.folder / "elsewhere")], capture_output=True, text=True, timeout=60)
    check(done.returncode == 1 and "is not that of" in done.stderr and done.stderr.count("\n") == 1, "another folder is refused: " + done.stderr)


def main():
    if "RIGCAL_TEST_POSTGRES" not in os.environ:
        os.execv(ROOT / "tests/postgres/with_postgres", ["with_postgres", sys.executable, __file__])
    with Flow() as flow:
        refusals(str(flow.folder / "other"))
    check(on_postgres() == on_sqlite(), "the same ids and digests as of one quiet server")


main()
