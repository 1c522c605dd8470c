"""How long a query takes: inside one process, and as a cold command."""
import pathlib
import statistics
import time

from .measure import at_most, skip
from .server import ANSWERED, Server


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
