"""Simulated power losses, syncs that do nothing, and operations that fail one by one: tests/fault/, at length."""
import json
import os
import subprocess
import sys

from ..measure import DEBIAN_PICTURES, at_least, equal, info, skip

LOSSES, LOSSES_FULL = 250, 1000  # of chance alone in --full; those of chosen points come on top
RECOVERED_FULL = 20


def told_by(context, test, *options):
    done = subprocess.run([sys.executable, str(context.root / "tests" / "fault" / test), "--json", *map(str, options)], capture_output=True,
                          text=True, timeout=7200, env={**os.environ, "RIGCAL_BIN": str(context.bin)})
    if done.returncode not in (0, 1):
        raise RuntimeError("%s: exit %d: %s" % (test, done.returncode, done.stderr[-300:]))
    return json.loads(done.stdout)


def power_losses(context):
    told = told_by(context, "power_loss_test.py", *(("--chances", LOSSES_FULL, "--recovered", RECOVERED_FULL) if context.full else ()))
    yield at_least("simulated_power_losses", told["losses"], LOSSES_FULL if context.full else LOSSES)
    yield info("of_them_served_again_and_pushed_to_until_equal", told["recovered"])
    yield equal("lost_or_twice_or_different_after_power_losses", len(told["failures"]), 0, detail=told["failures"])
    yield equal("syncs_without_which_a_loss_is_seen", told["caught"], told["listed"])


def nth_failures(context):
    told = told_by(context, "nth_failure_test.py", *(("--all",) if context.full else ()))
    yield info("operations_that_failed_one_by_one", told["failed"])
    yield info("pushes_refused_in_a_sentence", told["refused"])
    yield equal("failures_that_were_not_borne", len(told["failures"]), 0, detail=told["failures"])


def run(context):
    if not (context.stereo_pairs() / "left01.jpg").exists():
        yield skip("simulated_power_losses", "no pictures in %s" % DEBIAN_PICTURES)
    else:
        yield from power_losses(context)
    yield from nth_failures(context)
