"""Two lidars which no board ties together, alone or beside cameras that are refined without them: each pair has to tell by itself whether a sensor was moved
meanwhile. Whole sessions of clouds and pictures, from files to the verdict."""
import json
import pathlib
import random
import re
import subprocess

from ..measure import at_most, equal, info
from ..rotations import composed, of_vector
from ..server import ANSWERED, Server

LIDARS = ("lidar_vertical", "lidar_horizontal")
CAMERAS = ("front_left", "front_right")
# What is moved half-way, by m and deg; nobody in the first.
BUMPS = (None, ("lidar_horizontal", "0.02,2"), ("lidar_horizontal", "0.05,0.5"), ("lidar_vertical", "0.02,2"))


def rig_of(printed, wanted):
    """Of the built-in rig's YAML these sensors alone; no camera is calibrated with a lidar."""
    begin, end = printed.index("sensors:\n") + len("sensors:\n"), printed.index("\n# The upright lidar")
    sensors = [one for one in re.split(r"(?m)^(?=  \w+:)", printed[begin:end]) if one.strip().split(":")[0] in wanted]
    rig = printed[:begin] + "".join(one.rstrip() + "\n" for one in sensors)
    apart = ["[%s, %s]" % (camera, lidar) for camera in CAMERAS for lidar in LIDARS if camera in wanted]
    if apart:
        rig += "skip_pairs: [%s]\n" % ", ".join(apart)
    return rig.replace("reference: front_left", "reference: " + wanted[0]).replace("mars-mapper", "two-lidars")


def write_tie(path, truth, seed):
    """A finished edge from the first camera to the first lidar, as sure as it says."""
    pose = re.search(r"(?m)^  %s:.*?p_m: \[(.*?)\].*?q_xyzw: \[(.*?)\]" % LIDARS[0], truth, re.S)
    chance = random.Random(seed)
    p, q = composed(tuple([float(x) for x in part.split(",")] for part in pose.groups()),
                    ([chance.gauss(0, 1e-3) for _ in range(3)], of_vector([chance.gauss(0, 5e-4) for _ in range(3)])))
    covariance = [[(1e-3 if row < 3 else 5e-4) ** 2 if row == column else 0 for column in range(6)] for row in range(6)]
    path.write_text(json.dumps({"format": 1, "edges": [{"frame_a": CAMERAS[0], "frame_b": LIDARS[0], "T_a_b": {"p_m": p, "q_xyzw": q},
                                                        "covariance": covariance, "method": "given"}]}))


def judged(context, folder, rig, seed, bump):
    """The verdict of one visit, whether it says that a sensor moved, and by how many of its sigmas the pose is off."""
    session = folder / "visit"
    moved = ("--bump", bump[0], "--bump-by", bump[1]) if bump else ()
    context.run_json("rigcal", "simulate", rig, "--out", session, "--seed", seed, *moved, "--json")
    with Server(context, folder / "data") as server:
        if CAMERAS[0] in rig.read_text():
            write_tie(folder / "tie.json", (session / "truth.yaml").read_text(), seed)
            server.rigcal("push-edges", folder / "tie.json", "--robot", "two-lidars")
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        if pushed.returncode not in ANSWERED:
            raise RuntimeError("rigcal push: exit %d: %s" % (pushed.returncode, pushed.stderr.strip()[-300:]))
        verdict = json.loads(server.rigcal("show", "two-lidars", "--json").stdout)["document"]["verdict"]
        compared = json.loads(server.rigcal("compare", "two-lidars", "--poses", session / "truth.yaml", "--json").stdout)
    return verdict["level"], " was moved during the session" in verdict["why"], compared["worst_sigmas"]


def rows_of(context, folder, name, rig, seeds, bumps):
    results = {bump: [] for bump in bumps}
    for seed in seeds:
        for number, bump in enumerate(bumps):
            own = folder / ("%s-%d-%d" % (name, seed, number))
            own.mkdir()
            results[bump].append(judged(context, own, rig, seed, bump))
    still = results.pop(None)
    yield equal("%s_of_%d_moved_said" % (name, len(still)), sum(said for _, said, _ in still), 0)
    yield at_most(name + "_worst_error_in_sigmas", max(sigmas for _, _, sigmas in still), 4.0)
    for bump, ones in results.items():
        title = "%s_%s_by_%s_of_%d" % (name, bump[0].split("_")[1], bump[1].replace(",", "_"), len(ones))
        yield equal(title + "_found", sum(said and level == "fail" for level, said, _ in ones), len(ones))
        yield info(title + "_error_in_sigmas", max(sigmas for _, _, sigmas in ones))


def run(context):
    with context.folder() as name:
        folder = pathlib.Path(name)
        printed = subprocess.run([str(context.bin / "rigcal"), "simulate", "--print-rig", "mars-mapper"], capture_output=True, text=True, check=True).stdout
        alone, beside = folder / "lidars.yaml", folder / "cameras.yaml"
        alone.write_text(rig_of(printed, LIDARS))
        beside.write_text(rig_of(printed, CAMERAS + LIDARS))
        yield from rows_of(context, folder, "lidars_alone", alone, range(1, 7) if context.full else (1,), BUMPS)
        yield from rows_of(context, folder, "lidars_beside_cameras", beside, range(1, 4) if context.full else (1,), BUMPS[:2])
