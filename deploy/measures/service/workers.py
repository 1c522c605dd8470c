"""Processes that calibrate for one server on PostgreSQL: one of three is killed amid a job, one stands still beyond its lease and wakes."""
import os
import re
import subprocess
import sys

from ..measure import at_most, equal, skip

TAKEOVER_MAX_S = 15.0  # 10 s of the lease, 2 s until somebody looks, and the job that one is at
NOT_HERE = 77


def run(context):
    done = subprocess.run([sys.executable, str(context.root / "tests/e2e/faults/workers_test.py")], capture_output=True, text=True, timeout=900,
                          env={**os.environ, "RIGCAL_BIN": str(context.bin), "PYTHONDONTWRITEBYTECODE": "1"})
    if done.returncode == NOT_HERE:
        yield skip("takeover", "PostgreSQL is not installed")
        return
    yield equal("killed_and_stalled_change_nothing", done.returncode, 0, detail=done.stderr.splitlines())
    for seconds in re.findall(r"taken over ([0-9.]+) s after", done.stdout):
        yield at_most("takeover_after_kill_9", float(seconds), TAKEOVER_MAX_S, "s")
