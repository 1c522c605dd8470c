"""How many edges per second robots store on one PostgreSQL, by one server and by two on networks of their own: writers of a database take
turns. Run by servers.py, with a database server of its own."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "deploy"))
sys.path.insert(0, str(ROOT / "tests" / "e2e"))
from edges_files import block_edges  # noqa: E402
from measures.measure import Context  # noqa: E402
from measures.server import ANSWERED, Server  # noqa: E402

EDGES, ROBOTS = 100, 8


def database(name):
    before, after = os.environ["RIGCAL_TEST_POSTGRES"], os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]
    subprocess.run(["psql", "--quiet", "--no-psqlrc", before + "postgres" + after, "--command", "CREATE DATABASE " + name], check=True)
    return before + name + after


def pushed_by(servers, path):
    """Robots that push at once, in turn to each server; the seconds until all have their receipts."""
    began = time.monotonic()
    pushes = [subprocess.Popen(server.client("push-edges", path, "--robot", "rig-%d" % robot, "--no-wait"), env=server.environment(),
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
              for robot in range(ROBOTS) for server in [servers[robot % len(servers)]]]
    for one in pushes:
        _, said = one.communicate(timeout=600)
        if one.returncode not in ANSWERED:
            raise RuntimeError("push-edges: " + said)
    return time.monotonic() - began


def edges_per_s(context, count):
    with tempfile.TemporaryDirectory(prefix="rigcal-servers-") as folder:
        os.environ["RIGCAL_STORE"] = database("servers_%d" % count)
        path = block_edges(pathlib.Path(folder) / "edges.json", EDGES)
        servers = [Server(context, pathlib.Path(folder) / "store") for _ in range(count)]
        try:
            for server in servers:
                server.start("--threads", "0").wait_ready()
            return EDGES * ROBOTS / pushed_by(servers, path)
        finally:
            for server in servers:
                server.stop()


def main():
    context = Context(full=False)
    context.bin = pathlib.Path(os.environ["RIGCAL_BIN"])
    for count in (1, 2):
        print("%d: %.0f edges/s" % (count, edges_per_s(context, count)), flush=True)


main()
