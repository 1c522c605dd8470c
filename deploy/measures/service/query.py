"""How long a query takes: inside one process, as a cold command, and over HTTP while others hold connections half open."""
import pathlib
import selectors
import socket
import statistics
import threading
import time
import urllib.request

from ..measure import at_most, equal, skip
from ..server import ANSWERED, Server


class HalfOpen:
    """Clients that connect and say nothing, or a byte of their request now and then; each comes back when it is put out."""

    def __init__(self, address, count):
        host, port = address.removeprefix("http://").rsplit(":", 1)
        self.place, self.count, self.stopped = (host, int(port)), count, threading.Event()
        self.selector, self.thread = selectors.DefaultSelector(), threading.Thread(target=self.hold)

    def connect(self, idx):
        one = socket.create_connection(self.place, timeout=20)
        one.setblocking(False)
        if idx % 2:
            one.send(b"GET / HTTP/1.1\r\nX: ")
        self.selector.register(one, selectors.EVENT_READ, idx)

    def hold(self):
        while not self.stopped.is_set():
            for key, _ in self.selector.select(timeout=0.2):
                self.selector.unregister(key.fileobj)
                key.fileobj.close()
                self.connect(key.data)
            for key in [key for key in self.selector.get_map().values() if key.data % 2]:
                try:
                    key.fileobj.send(b"a")
                except OSError:
                    pass  # put out: select tells

    def __enter__(self):
        for idx in range(self.count):
            self.connect(idx)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopped.set()
        self.thread.join()
        for key in list(self.selector.get_map().values()):
            key.fileobj.close()


def http_times_s(address, count):
    """Of those that were answered, in order."""
    times_s = []
    for _ in range(count):
        start = time.perf_counter()
        try:
            with urllib.request.urlopen(address + "/healthz", timeout=2) as reply:
                reply.read()
            times_s.append(time.perf_counter() - start)
        except OSError:
            pass
    return sorted(times_s)


def half_open(server):
    for count in (200, 800):
        with HalfOpen(server.address, count):
            times_s = http_times_s(server.address, 30)
        yield equal("http_answers_beside_%d_half_open" % count, len(times_s), 30)
        yield at_most("http_p99_beside_%d_half_open" % count, (times_s or [60.0])[-1], 0.5, "s")


def run(context):
    path = context.data / "posegraph_synthetic" / "rig_12_59.g2o"
    if not path.exists():
        yield skip("rig_12_59", "no data")
        return
    with context.folder() as temporary, Server(context, pathlib.Path(temporary) / "store") as server:
        if server.rigcal("push-edges", path, "--robot", "rig").returncode not in ANSWERED:
            raise RuntimeError("push-edges failed")
        times_ms = []
        for _ in range(25):
            start = time.perf_counter()
            done = server.rigcal("lookup", "rig", "0", "11")
            times_ms.append((time.perf_counter() - start) * 1e3)
            if done.returncode not in ANSWERED:
                raise RuntimeError("lookup: " + done.stderr)
        yield at_most("cold_lookup_median", statistics.median(times_ms), 150.0, "ms")
        yield at_most("cold_lookup_worst_of_25", max(times_ms), 150.0, "ms")
        result = context.run_json("query_bench", "--tag", server.tag, "--robot", "rig", "--a", "0", "--b", "11", "--count", 2000, env=server.environment())
        yield at_most("round_trip_median", result["median_ms"], 3.0, "ms")
        yield at_most("round_trip_p99", result["p99_ms"], 10.0, "ms")
        yield from half_open(server)
