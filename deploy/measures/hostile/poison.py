"""A session of pictures that take more memory than the server has, beside another robot's work and questions."""
import json
import pathlib
import statistics
import sys
import time

from ..measure import at_most, equal, info, skip
from ..server import ANSWERED, Server

E2E = pathlib.Path(__file__).resolve().parents[3] / "tests" / "e2e"
sys.path[:0] = [str(E2E / "hostile"), str(E2E)]
PICTURES, RUNS, QUESTIONS = 12, 5, 400
PATIENCE_S = 240


def p99_ms(context, server):
    """Of one run of questions."""
    asked = ("--tag", server.tag, "--robot", "rig", "--a", "0", "--b", "11", "--count", QUESTIONS)
    return context.run_json("query_bench", *asked, env=server.environment())["p99_ms"]


def edges(server, robot):
    done = server.rigcal("edges", robot, "--json")
    return json.loads(done.stdout)["edges"] if done.returncode in ANSWERED else []


def run(context):
    from bad_inputs import GOOD, write
    from bad_session import YAML
    from poison_test import ADDRESS_SPACE_BYTES, address_space, black_pngs
    path = context.data / "posegraph_synthetic" / "rig_12_59.g2o"
    if not path.exists():
        yield skip("rig_12_59", "no data")
        return
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        names = ["%s/%02d.png" % (side, k + 1) for k in range(PICTURES // 2) for side in ("left", "right")]
        poison = write(folder / "poison", YAML.replace("ROBOT", "poison"), dict(zip(names, black_pngs(PICTURES))))
        beside = write(folder / "beside", YAML.replace("ROBOT", "beside"), GOOD)
        with address_space(ADDRESS_SPACE_BYTES):
            server = Server(context, folder / "store").start()
        try:
            server.wait_ready()
            first = server.process.pid
            if server.rigcal("push-edges", path, "--robot", "rig").returncode not in ANSWERED:
                raise RuntimeError("push-edges failed")
            quiet_ms = statistics.median([p99_ms(context, server) for _ in range(RUNS + 1)][1:])  # the first make what later ones find
            began = time.monotonic()
            if server.rigcal("push", poison, "--no-wait", "--new-robot").returncode != 0 or server.rigcal("push", beside, "--no-wait", "--new-robot").returncode != 0:
                raise RuntimeError("push failed")
            busy = []
            while not (edges(server, "poison") and edges(server, "beside")) and time.monotonic() - began < PATIENCE_S:
                busy.append(p99_ms(context, server))
            busy_ms = statistics.median(busy)
            failed = [edge for edge in edges(server, "poison") if edge["state"] == "failed"]
            yield equal("poison_failed_edges_with_a_sentence_and_a_cure", sum(bool(edge["diagnoses"]) and all(one["cure"] for one in edge["diagnoses"]) for edge in failed), 1)
            yield equal("other_robots_good_edges", sum(edge["state"] == "good" for edge in edges(server, "beside")), 1)
            yield equal("server_is_the_same_process", int(server.process.poll() is None and server.process.pid == first), 1)
            yield info("runs_beside_poison", len(busy))
            yield at_most("lookup_p99_over_quiet", busy_ms / quiet_ms, 2.0)
            yield info("lookup_p99_quiet", quiet_ms, "ms")
            yield info("lookup_p99_beside_poison", busy_ms, "ms")
        finally:
            server.stop()
