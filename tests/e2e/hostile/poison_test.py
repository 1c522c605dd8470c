"""A session of pictures that take more memory than there is, and one whose job crashes again and again, beside good ones: each ends
as a failed edge that says why, the server serves on, and nobody else waits."""
import contextlib
import json
import os
import pathlib
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from bad_inputs import GOOD, write  # noqa: E402
from bad_session import YAML, chunk  # noqa: E402
from flow import Flow, check  # noqa: E402

SIDE_PX, CAPTURES = 14_000, 20
ADDRESS_SPACE_BYTES = 2_000_000 << 10
PATIENCE_S = 240


def black_pngs(count):
    """Distinct files of one black picture, packed once: each has a comment of its own."""
    packer, row = zlib.compressobj(1), b"\0" * (SIDE_PX + 1)
    data = b"".join(packer.compress(row * 100) for _ in range(SIDE_PX // 100)) + packer.flush()
    head = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIDE_PX, SIDE_PX, 8, 0, 0, 0, 0))
    tail = chunk(b"IDAT", data) + chunk(b"IEND", b"")
    return [head + chunk(b"tEXt", b"Comment\0picture %d" % index) + tail for index in range(count)]


def poison_session(folder):
    pictures = black_pngs(2 * CAPTURES)
    files = {"%s/%02d.png" % (side, k + 1): pictures[2 * k + at] for k in range(CAPTURES) for at, side in enumerate(("left", "right"))}
    return write(folder, YAML.replace("ROBOT", "poison"), files)


@contextlib.contextmanager
def address_space(limit_bytes):
    """What is started meanwhile has no more of it."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (limit_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def edges_of(flow, robot):
    return json.loads(flow.get("/api/v1/edges?robot=" + robot))["edges"]


def log_of(flow):
    return (flow.folder / "store.log").read_text()


def wait_for(flow, what, ready):
    ends = time.monotonic() + PATIENCE_S
    while not ready():
        check(time.monotonic() < ends, what + ":\n" + log_of(flow)[-2000:])
        with contextlib.suppress(subprocess.TimeoutExpired):
            flow.server.process.wait(timeout=0.05)
            check(False, "the server lives while we wait for %s:\n%s" % (what, log_of(flow)[-2000:]))


def push_good(flow, name):
    session = write(flow.folder / name, YAML.replace("ROBOT", name), GOOD)
    check(flow.server.rigcal("push", session, "--new-robot").returncode in (0, 5, 6), name + " is calibrated")
    check(edges_of(flow, name)[0]["state"] == "good", name + " has a good edge")


def failed_edge(flow):
    wait_for(flow, "the failed edge of the poison", lambda: edges_of(flow, "poison"))
    edge = edges_of(flow, "poison")[0]
    check(edge["state"] == "failed" and all(one["cure"] for one in edge["diagnoses"]), "it failed, with a cure: %r" % edge)
    return " ".join(one["what"] for one in edge["diagnoses"])


def little_memory(session):
    with contextlib.ExitStack() as stack:
        with address_space(ADDRESS_SPACE_BYTES):
            flow = stack.enter_context(Flow())
        first = flow.server.process.pid
        flow.rigcal("push", session, "--no-wait", "--new-robot")
        push_good(flow, "beside")
        said = failed_edge(flow)
        check(re.search(r'file "left/\d\d\.png" of 14000 x 14000 pixels would take \d+ MiB of memory, and this server has \d+ MiB for that', said),
              "the picture, its size and the limit are named: " + said)
        push_good(flow, "after")
        check(flow.server.process.poll() is None and flow.server.process.pid == first, "the server never died")
        check("job 1: left and right of robot poison" in log_of(flow), "the log tells of the job")
        print("little memory: %s" % said[:200])


def begun(flow, attempt, times):
    return len(re.findall(r"job 1: .*attempt %d of 3" % attempt, log_of(flow))) == times


def crash_and_restart(flow):
    flow.server.process.send_signal(signal.SIGABRT)
    flow.server.process.wait()
    flow.server.start()
    flow.address = flow.ready()


def crashed_thrice(session):
    with Flow() as flow:
        flow.rigcal("push", session, "--no-wait", "--new-robot")
        wait_for(flow, "the first attempt", lambda: begun(flow, 1, 1))
        flow.kill_and_restart()  # from outside: not the work's doing
        wait_for(flow, "the first attempt again", lambda: begun(flow, 1, 2))
        crash_and_restart(flow)
        push_good(flow, "beside")  # what was cut off comes after all others
        wait_for(flow, "the second attempt", lambda: begun(flow, 2, 1))
        flow.server.stop()  # an orderly stop does not count
        flow.server.start()
        flow.address = flow.ready()
        wait_for(flow, "the second attempt again", lambda: begun(flow, 2, 2))
        crash_and_restart(flow)
        wait_for(flow, "the third attempt", lambda: begun(flow, 3, 1))
        crash_and_restart(flow)
        said = failed_edge(flow)
        check("the server died 3 times while it calibrated left and right of robot poison" in said, "the reason: " + said)
        push_good(flow, "after")
        print("crashed thrice: %s" % said[:200])


def workers_of(flow):
    """Processes that work for the server."""
    return [pid for pid in flow.server.processes() if pid != flow.server.process.pid]


def busiest(pids):
    """The one that has used most processor time: that which is at the poison."""
    def ticks(pid):
        fields = pathlib.Path("/proc/%d/stat" % pid).read_text().rsplit(") ", 1)[1].split()
        return int(fields[11]) + int(fields[12])
    return max(pids, key=ticks)


def worker_died(session):
    """What ends the process that works costs that work, and not the server."""
    with Flow() as flow:
        first = flow.server.process.pid
        flow.rigcal("push", session, "--no-wait", "--new-robot")
        for attempt in (1, 2, 3):
            wait_for(flow, "attempt %d" % attempt, lambda: begun(flow, attempt, 1))
            os.kill(busiest(workers_of(flow)), signal.SIGSEGV)
            push_good(flow, "beside-%d" % attempt)
        said = failed_edge(flow)
        check("it failed 3 times when it calibrated left and right of robot poison" in said and "signal 11 (Segmentation fault)" in said, "the reason: " + said)
        os.kill(busiest(workers_of(flow)), signal.SIGKILL)  # an idle one: nobody sees it
        push_good(flow, "after")
        check(flow.server.process.pid == first and "stopped in the middle" not in log_of(flow), "the server never died")
        pids = workers_of(flow)
        flow.server.process.send_signal(signal.SIGKILL)
        flow.server.process.wait()
        ends = time.monotonic() + 10
        while any(pathlib.Path("/proc/%d" % pid).exists() for pid in pids):
            check(time.monotonic() < ends, "those that work end with their server")
        flow.server.start()
        flow.address = flow.ready()
        push_good(flow, "again")
        print("worker died: %s" % said[:300])


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-poison-") as folder:
        session = poison_session(pathlib.Path(folder) / "poison")
        for part in (little_memory, worker_died, crashed_thrice):
            if not sys.argv[1:] or part.__name__ in sys.argv[1:]:
                part(session)
    print("poison: good")


if __name__ == "__main__":
    main()
