"""`rigcal check`: how long it looks at pictures of full size, and whether it tells a session that will do from those that will not."""
import json
import pathlib
import shutil
import subprocess
import time

from ..measure import at_least, at_most, equal, info

ENOUGH, MORE = 0, 5


def simulated(context, folder, *arguments, rig="mars-mapper"):
    return context.run_json("rigcal", "simulate", rig, "--out", folder, "--json", *arguments)


def checked(context, session):
    """The exit code, the document, and the seconds it took as a process."""
    began = time.monotonic()
    done = subprocess.run([str(context.bin / "rigcal"), "check", str(session), "--json"], capture_output=True, text=True, timeout=600)
    took_s = time.monotonic() - began
    if done.returncode not in (ENOUGH, MORE):
        raise RuntimeError("rigcal check: exit %d: %s" % (done.returncode, done.stderr.strip()[-300:]))
    return done.returncode, json.loads(done.stdout), took_s


def without_half(session, sensor):
    """The same session, in whose second half the sensor has no files."""
    copy = session.parent / (session.name + "-half")
    shutil.copytree(session, copy)
    files = sorted((copy / sensor).iterdir())
    for path in files[len(files) // 2:]:
        path.unlink()
    return copy


def straight_rig(context, folder):
    """The rig before boards that stand upright, on a robot that never turns."""
    rig = subprocess.run([str(context.bin / "rigcal"), "simulate", "--print-rig", "mars-mapper"], capture_output=True, text=True, check=True).stdout
    for moved, still in (("yaw_range_deg: 16", "yaw_range_deg: 0"), ("tilt_rms_deg: 5", "tilt_rms_deg: 0"), ("rpy_deg: [3, 12, -10]", "rpy_deg: [0, 0, 0]")):
        if rig.count(moved) != 1:
            raise RuntimeError("the rig has no single " + moved)
        rig = rig.replace(moved, still)
    path = folder / "straight.yaml"
    path.write_text(rig)
    return path


def advice_on(document, sensor):
    return " ".join(advice["text"] for advice in document["advice"] if sensor in advice["of"])


def speed(context, folder):
    pictures = simulated(context, folder / "full", "--captures", 8)["pictures"]
    _, document, took_s = checked(context, folder / "full")
    yield at_most("check_s_per_10_pictures_5mp", 10 * took_s / pictures, 1.0, "s")
    yield info("boards_found_5mp", "%d/%d" % (sum(len(camera["board_in"]) for camera in document["cameras"]), pictures))


def verdicts(context, folder):
    good = folder / "quickstart"
    simulated(context, good, "--scale", 0.5, "--captures", 30)
    code, document, took_s = checked(context, good)
    yield equal("quickstart_session_is_enough", code == ENOUGH and document["enough"], True)
    yield equal("quickstart_pairs_that_fail", sum(pair["state"] == "failed" for pair in document["pairs"]), 0)
    yield info("quickstart_session", took_s, "s")
    simulated(context, folder / "three", "--scale", 0.5, "--captures", 3)
    code, document, _ = checked(context, folder / "three")
    yield at_least("of_three_captures_takes_more", document["captures_more"] if code == MORE else 0, 7)
    _, document, _ = checked(context, without_half(good, "front_left"))
    told = "front_left has files for 15 of 30 captures: 16 to 30 are missing." in document["remarks"]
    yield equal("half_of_a_camera_missing_is_told", told, True)
    simulated(context, folder / "straight", "--scale", 0.5, "--captures", 12, "--intrinsics", "absent", rig=straight_rig(context, folder))
    code, document, _ = checked(context, folder / "straight")
    yield equal("boards_always_frontal_are_told_to_be_tilted", code == MORE and "tilt the board" in advice_on(document, "front_left"), True)


def run(context):
    with context.folder() as name:
        yield from speed(context, pathlib.Path(name))
    with context.folder() as name:
        yield from verdicts(context, pathlib.Path(name))
