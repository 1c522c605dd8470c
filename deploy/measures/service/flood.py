"""One robot pushes as fast as it can; another's questions are timed before and meanwhile, on one server.

The client that floods, the server and the one that asks share the processors here; the one that asks runs in real time,
as if it had a machine of its own. While somebody asks, the server takes payloads in no faster than 96 MiB/s
(docs/limits.md)."""
import json
import pathlib
import subprocess
import threading

from ..measure import at_most, info
from ..server import ANSWERED, Server
from ..sessions import noise_session

ROUNDS = 5
COUNT, WARM_UP = 4000, 500
PAYLOAD_BYTES, PAYLOADS = 3_000_000, 100
EDGES = 4000


def edge_file(path, count, shift_m):
    """Edges that no other file has, between sensors of a chain."""
    information = [[1e6 if row == column else 0.0 for column in range(6)] for row in range(6)]
    edges = [{"frame_a": "s%d" % (k % 60), "frame_b": "s%d" % (k % 60 + 1), "information": information,
              "T_a_b": {"p_m": [1.0 + shift_m + 1e-6 * k, 0.0, 0.0], "q_xyzw": [0.0, 0.0, 0.0, 1.0]}} for k in range(count)]
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return path


class Flood:
    """A client that pushes without a pause until the end of the block. `prepare(k)` gives the k-th command."""

    def __init__(self, server, prepare):
        self.server, self.prepare, self.stopped, self.pushed = server, prepare, threading.Event(), 0
        self.process, self.problem = None, ""
        self.thread = threading.Thread(target=self.run)

    def run(self):
        while not self.stopped.is_set():
            self.process = subprocess.Popen(self.server.client(*self.prepare(self.pushed)), stdout=subprocess.DEVNULL,
                                            stderr=subprocess.PIPE, text=True, env=self.server.environment())
            said = self.process.communicate()[1]
            if not self.stopped.is_set() and self.process.returncode not in ANSWERED:
                self.problem = said[-300:]
                return
            self.pushed += 1

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopped.set()
        if self.process:
            self.process.terminate()
        self.thread.join()
        if self.problem:
            raise RuntimeError("the flood broke off: " + self.problem)


def query(context, server, count=COUNT):
    return context.run_json("query_bench", "--tag", server.tag, "--robot", "quiet", "--a", "s0", "--b", "s9", "--count", count,
                            env=server.environment())


def payloads(folder):
    """A session whose bytes are new each time, so that all of them travel."""
    session = noise_session(folder / "flood", "loud", PAYLOAD_BYTES, PAYLOADS, seed=1)
    files = sorted(session.glob("*/*.png"))

    def prepare(idx):
        for path in files:
            with open(path, "r+b") as file:
                file.seek(100)
                file.write(b"%016d" % idx)
        return "push", session, "--no-wait"
    return prepare


def edges(folder):
    """A file of edges that are new each time."""
    def prepare(idx):
        return "push-edges", edge_file(folder / "flood.json", EDGES, 1e-3 * idx), "--robot", "loud", "--no-wait"
    return prepare


def one_round(context, folder, make):
    """The times of questions in quiet and while another floods the server; how often that one pushed."""
    with Server(context, folder / "store") as server:
        done = server.rigcal("push-edges", edge_file(folder / "quiet.json", 60, 0.0), "--robot", "quiet")
        if done.returncode not in ANSWERED:
            raise RuntimeError("push-edges: " + done.stderr[-300:])
        prepare, times = make(folder), {"quiet": query(context, server)}
        with Flood(server, prepare) as flood:
            query(context, server, WARM_UP)
            times["flood"] = query(context, server)
        return times, flood.pushed


def run(context):
    for make in (payloads, edges):
        kind, ratios = make.__name__, []
        for round_idx in range(ROUNDS):
            with context.folder() as temporary:
                times, pushed = one_round(context, pathlib.Path(temporary), make)
            for name, one in times.items():
                yield info("%s_query_p99_%s_%d" % (name, kind, round_idx), one["p99_ms"], "ms")
            yield info("flood_query_median_%s_%d" % (kind, round_idx), times["flood"]["median_ms"], "ms")
            yield info("flood_pushes_%s_%d" % (kind, round_idx), pushed)
            ratios.append(times["flood"]["p99_ms"] / times["quiet"]["p99_ms"])
        yield at_most("flood_query_p99_ratio_" + kind, sorted(ratios)[ROUNDS // 2], 2.0)
