"""The capture companion: how many captures its advice saves, and how soon a new capture is shown."""
import json
import pathlib
import shutil
import subprocess
import time
import urllib.request

from ..measure import at_least, at_most, equal, info

SHOWN_WITHIN_S = 1.0


def followed(context):
    """An operator who holds the board where the advice says, against one who tilts it at random. What ends a session is what the
    joint refinement tells of noisy corners, and its error from the simulator's truth; never what the advice expects."""
    told = context.run_json("companion_measure", 50, timeout=1800)
    yield at_most("captures_by_advice_over_random", told["captures_ratio"], 0.6, detail=["%(advised)s against %(random)s captures of all rigs" % told])
    yield info("captures_until_each_pair_has_8_by_advice_over_random", told["advised_paired"] / told["random_paired"],
               detail=["%(advised_paired)s against %(random_paired)s captures of all rigs" % told])
    yield equal("advised_sessions_that_do_not_end", told["advised_unended"], 0)
    yield at_least("advised_errors_within_3_sigma_ratio", told["within_3_sigma_ratio"], 0.98)
    yield at_most("told_sigma_over_sigma_so_far_median", told["told_over_expected"], 1.5)
    yield info("next_placement", told["advice_ms"], "ms")


def document(address):
    with urllib.request.urlopen(address + "/api/v1/companion", timeout=5) as reply:
        return json.load(reply)


def seconds_until(address, ready, patience_s=30.0):
    began = time.monotonic()
    while not ready(document(address)):
        if time.monotonic() - began > patience_s:
            raise RuntimeError("the companion does not show the capture")
        time.sleep(0.01)
    return time.monotonic() - began


def move_capture(source, folder, capture):
    """Each file under another name first, as a recorder that cares does it."""
    for path in sorted(source.glob("*/%s.*" % capture)):
        target = folder / path.parent.name / path.name
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(path, target.with_name("." + path.name + ".part"))
        target.with_name("." + path.name + ".part").rename(target)


def shown(context, folder):
    """Pictures of 5 megapixels of two cameras come into the folder one capture after the other."""
    whole, growing = folder / "whole", folder / "growing"
    rig = pathlib.Path(__file__).with_name("companion_rig.yaml")
    context.run_json("rigcal", "simulate", rig, "--out", whole, "--captures", 6, "--json")
    growing.mkdir()
    shutil.copyfile(whole / "session.yaml", growing / "session.yaml")
    captures = sorted(path.stem for path in (whole / "left").iterdir())
    process = subprocess.Popen([str(context.bin / "rigcal"), "companion", str(growing), "--port", "0", "--json"], stdout=subprocess.PIPE, text=True)
    try:
        address = json.loads(process.stdout.readline())["address"]
        took_s = []
        for count, capture in enumerate(captures, 1):
            move_capture(whole, growing, capture)
            took_s.append(seconds_until(address, lambda told: not told["looking"] and all(sensor["files"] == count for sensor in told["sensors"])))
        yield at_most("capture_shown_slowest_of_%d" % len(took_s), max(took_s), SHOWN_WITHIN_S, "s")
    finally:
        process.terminate()
        process.wait(timeout=20)


def run(context):
    yield from followed(context)
    with context.folder() as name:
        yield from shown(context, pathlib.Path(name))
