"""Several servers on one PostgreSQL and one folder: the one that speaks DDS is killed amid a push, another stands still and wakes; how many
edges they store; and a store that comes there from SQLite."""
import os
import re
import subprocess
import sys

from ..measure import at_least, at_most, equal, info, skip

MOVED_MAX_S = 120.0  # a store of 1,000 robots
KILLS_MIN = 10
GOES_ON_MAX_S = 15.0  # 3 s until the killed one is known to be gone, its place is taken, and what had no receipt is sent again
NOT_HERE = 77


def on_postgres(context, *command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=900,
                          env={**os.environ, "RIGCAL_BIN": str(context.bin), "PYTHONDONTWRITEBYTECODE": "1"})


def moved(context):
    done = on_postgres(context, context.root / "tests/postgres/with_postgres", sys.executable, context.root / "deploy/measures/service/moved_store.py")
    yield equal("store_moved_to_postgres", done.returncode, 0, detail=done.stderr.splitlines())
    told = {name: float(value) for name, value in re.findall(r"(\w+) ([0-9.]+)", done.stdout)} if done.returncode == 0 else {}
    if not told:
        return
    yield at_most("move_of_1000_robots", told["seconds"], MOVED_MAX_S, "s")
    yield info("move_rows", int(told["rows"]))
    yield at_least("move_kills", int(told["kills"]), KILLS_MIN)
    yield equal("ids_digests_documents_files_that_differ", int(told["differences"]), 0)


def run(context):
    done = on_postgres(context, sys.executable, context.root / "tests/e2e/faults/several_servers_test.py")
    if done.returncode == NOT_HERE:
        yield skip("goes_on", "PostgreSQL is not installed")
        return
    yield equal("killed_and_stalled_change_nothing", done.returncode, 0, detail=done.stderr.splitlines())
    for seconds in re.findall(r"receipt ([0-9.]+) s after the kill", done.stdout):
        yield at_most("push_has_its_receipt_after_kill_9", float(seconds), GOES_ON_MAX_S, "s")
    stored = on_postgres(context, context.root / "tests/postgres/with_postgres", sys.executable, context.root / "deploy/measures/service/edges_of_servers.py")
    yield equal("edges_stored_by_one_and_by_two", stored.returncode, 0, detail=stored.stderr.splitlines())
    for count, rate in re.findall(r"(\d): (\d+) edges/s", stored.stdout):
        yield info("edges_by_%s_of_several" % count, int(rate), "/s")
    yield from moved(context)
