"""Cameras in front and behind that share no board, each pair before boards of its own that are carried about: nothing in the session ties the one pair to
the other. What is not connected is a problem of its own, and is to be judged like any. Whole sessions of pictures, from files to the verdict."""
import json
import math
import pathlib
import random
import re

from ..measure import at_least, at_most, equal, info
from ..rotations import composed, inverse, of_vector
from ..server import ANSWERED, Server

RIG = """format: 1
name: islands
robot: islands
reference: left
nominal_sigma_m: 0.01
nominal_sigma_deg: 1
motion: {captures: 40, start_m: [0, 0, 1], position_range_m: [0.5, 0.5, 0.2], yaw_range_deg: 9, tilt_rms_deg: 5}
boards:
  board: {inner_corners: [10, 7], square_size_m: 0.06, plate_size_m: [0.75, 0.56], T_world_plate: {p_m: [2.0, 0, 1.0], rpy_deg: [3, 8, 10]}}
room: {size_m: [7.4, 7.4, 4.4], patches_per_wall: 16}
camera: {size_px: [1280, 960], blur_px: 0.7, noise_grey: 2, corner_sigma_px: 0.03}
sensors:
  left:
    {type: camera, T_body_sensor: {p_m: [0.300, 0.150, 0.002], rpy_deg: [0.3, 0.4, -2.5]},
     lens: {fx_px: 860.3, fy_px: 861.6, cx_px: 641.4, cy_px: 482.7, distortion: [-0.0812, 0.0731, 0.00032, -0.00021, -0.0112]}}
  right:
    {type: camera, T_body_sensor: {p_m: [0.301, -0.151, -0.001], rpy_deg: [-0.4, 0.2, 2.6]},
     lens: {fx_px: 851.9, fy_px: 851.4, cx_px: 630.2, cy_px: 471.9, distortion: [-0.0795, 0.0702, -0.00018, 0.00041, -0.0098]}}
"""
NAMES = ("left", "right", "board")
# What is wrong with the pair behind; nothing in the first.
WRONGS = {None: (), "exchanged_intrinsics": (), "bump_20_mm": ("--bump", "rear_right", "--bump-by", "0.02,2"), "bump_2_mm": ("--bump", "rear_right", "--bump-by", "0.002,0.2"),
          "capture_off_8_px": ("--shift-capture", "8@30:rear_right"), "lens_misfit_0.1_px": ("--lens-misfit", "0.1")}
TIE = ([-0.6, 0.02, 0.1], of_vector([0.02, 3.1, 0.03]))  # T_left_rear_left


def rig_behind():
    rig = RIG
    for name in NAMES:
        rig = re.sub(r"(?m)^  %s:" % name, "  rear_%s:" % name, rig)
    return rig.replace("reference: left", "reference: rear_left")


def section(text, name):
    """The indented lines of a YAML section."""
    return re.search(r"(?m)^%s:\n((?:  .*\n)+)" % name, text).group(1)


def exchanged(sensors):
    first, second = re.findall(r"(?m)^    intrinsics: .*$", sensors)
    return sensors.replace(first, "    intrinsics: {}").replace(second, first).replace("    intrinsics: {}", second)


def join(front, rear, session, wrong):
    """One session of both: boards and sensors of the other beside its own."""
    front.rename(session)
    for folder in rear.glob("rear_*"):
        folder.rename(session / folder.name)
    ours, theirs = (session / "session.yaml").read_text(), (rear / "session.yaml").read_text()
    sensors = re.sub(r"(?m)^    T_ref_nominal: .*\n", "", section(theirs, "sensors"))  # of another reference
    for name, added in (("targets", section(theirs, "targets")), ("sensors", exchanged(sensors) if wrong == "exchanged_intrinsics" else sensors)):
        ours = ours.replace(section(ours, name), section(ours, name) + added)
    ours = re.sub(r"(?m)^(  (rear_)?(left|right):\n)", r"\1    sees: \2board\n", ours)
    apart = ", ".join("[%s, rear_%s]" % (one, other) for one in NAMES[:2] for other in NAMES[:2])
    (session / "session.yaml").write_text("%s\nskip_pairs: [%s]\n" % (ours, apart))


def numbers(text):
    return [float(one) for one in text.split(",")]


def pose_in(truth, sensor):
    pose = re.search(r"(?m)^  %s:\n.*\n    T_ref_sensor: \{p_m: \[(.*?)\], q_xyzw: \[(.*?)\]\}" % sensor, truth)
    return tuple(numbers(part) for part in pose.groups())


def write_tie(path, seed):
    """A finished edge from the one pair to the other, as sure as it says."""
    chance, sigmas = random.Random(seed), [2e-4] * 3 + [1e-4] * 3
    p, q = composed(TIE, ([chance.gauss(0, sigmas[i]) for i in range(3)], of_vector([chance.gauss(0, sigmas[i]) for i in range(3, 6)])))
    covariance = [[sigmas[row] ** 2 if row == column else 0 for column in range(6)] for row in range(6)]
    path.write_text(json.dumps({"format": 1, "edges": [{"frame_a": "left", "frame_b": "rear_left", "T_a_b": {"p_m": p, "q_xyzw": q},
                                                        "covariance": covariance, "method": "given"}]}))


def off_by(told, behind):
    """How far the pose of one sensor in the other is off, in mm and in told sigmas of its worst axis."""
    p, q = composed(inverse(behind), (told["T_a_b"]["p_m"], told["T_a_b"]["q_xyzw"]))
    axes = p + [2 * x * math.copysign(1, q[3]) for x in q[:3]]
    return 1e3 * math.sqrt(sum(x * x for x in p)), max(abs(x) / math.sqrt(told["covariance"][i][i]) for i, x in enumerate(axes))


def judged(context, folder, seed, wrong):
    """The verdict, what it says of the pair behind, and how far that is off."""
    for name, rig, number, options in (("front", RIG, seed, ()), ("rear", rig_behind(), 1000 + seed, WRONGS[wrong])):
        (folder / (name + ".yaml")).write_text(rig)
        context.run_json("rigcal", "simulate", folder / (name + ".yaml"), "--out", folder / name, "--seed", number, *options, "--json")
    behind = pose_in((folder / "rear" / "truth.yaml").read_text(), "rear_right")
    session = folder / "visit"
    join(folder / "front", folder / "rear", session, wrong)
    write_tie(folder / "tie.json", seed)
    with Server(context, folder / "data") as server:
        server.rigcal("push-edges", folder / "tie.json", "--robot", "islands")
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        if pushed.returncode not in ANSWERED:
            raise RuntimeError("rigcal push: exit %d: %s" % (pushed.returncode, pushed.stderr.strip()[-300:]))
        document = json.loads(server.rigcal("show", "islands", "--json").stdout)["document"]
        told = json.loads(server.rigcal("lookup", "islands", "rear_left", "rear_right", "--json").stdout)
    mm, sigmas = off_by(told, behind) if "T_a_b" in told else (math.inf, math.inf)
    why, fused = document["verdict"]["why"], document.get("fused", {})
    return {"level": document["verdict"]["level"], "moved": bool(re.search(r"rear_\w+( or rear_\w+)? was moved during the session", why)),
            "lens": "intrinsics" in why and "rear_left" in why and "rear_right" in why,
            "held_back": [[look["sensor"], look["capture"]] for look in fused.get("held_back", [])],
            "bends": [lens["camera"] for lens in fused.get("lenses", [])], "why": why,
            "mm": mm, "sigmas": sigmas}


def run(context):
    results = {wrong: [] for wrong in WRONGS}
    with context.folder() as name:
        for seed in range(1, 6 if context.full else 2):
            for number, wrong in enumerate(WRONGS):
                folder = pathlib.Path(name) / ("%d-%d" % (seed, number))
                folder.mkdir()
                results[wrong].append(judged(context, folder, seed, wrong))
    count = len(results[None])
    yield equal("islands_of_%d_accused" % count, sum(one["level"] == "fail" for one in results[None]), 0)
    for wrong, what in (("exchanged_intrinsics", "lens"), ("bump_20_mm", "moved"), ("bump_2_mm", "moved")):
        yield at_least("islands_%s_of_%d_found" % (wrong, count), sum(one[what] and one["level"] == "fail" for one in results[wrong]), count)
    shifted = results["capture_off_8_px"]
    yield equal("islands_capture_off_8_px_of_%d_named" % count, sum(["rear_right", "30"] in one["held_back"] for one in shifted), count)
    yield at_most("islands_capture_off_8_px_error", max(one["mm"] for one in shifted), 0.1, "mm")
    yield info("islands_lens_misfit_0.1_px_of_%d_lens_named" % count, sum(bool(one["bends"]) for one in results["lens_misfit_0.1_px"]))
    for wrong in (None, "capture_off_8_px", "lens_misfit_0.1_px"):
        yield at_most("islands_%s_worst_error_in_sigmas" % (wrong or "clean"), max(one["sigmas"] for one in results[wrong]), 4.0)
