"""Names that nobody has: a client asks and begins sessions for 1,000 robots that never bring anything. What is left of them after a minute?"""
import json
import pathlib
import time

from ..measure import at_most, equal, info
from ..server import Server

ROBOTS, WAIT_S = 1000, 60
WARM_UP, WARM_UP_WAIT_S = 20, 30


def speak(context, server, count, wait_s):
    return context.run_json("misspelt_robots", "--tag", server.tag, "--count", count, "--wait-s", wait_s, env=server.environment())


def run(context):
    with context.folder() as name, Server(context, pathlib.Path(name) / "data") as server:
        speak(context, server, WARM_UP, WARM_UP_WAIT_S)
        before_mib = server.rss_mib()
        began = time.monotonic()
        said = speak(context, server, ROBOTS, WAIT_S)
        yield equal("answered", said["answered"], ROBOTS)
        yield equal("receipts", said["received"], ROBOTS)
        yield info("ms_per_robot", 1e3 * (time.monotonic() - began - WAIT_S) / ROBOTS, "ms")
        yield info("writers_meanwhile", float(said["writers_meanwhile"]))
        yield equal("writers_of_robots_after_%d_s" % WAIT_S, said["writers_after"], 0)
        yield at_most("memory_after_%d_s_over_before" % WAIT_S, server.rss_mib() / before_mib, 1.1)
        yield equal("robots_stored", len(json.loads(server.rigcal("robots", "--json").stdout)["robots"]), 0)
