"""A robot of two lidars, which no board ties together: its sessions are not refined as a whole, and each pair has to tell by itself whether a sensor was
moved meanwhile. Whole sessions of clouds, from files to the verdict."""
import json
import pathlib
import re
import subprocess

from ..measure import at_most, equal, info
from ..server import ANSWERED, Server

LIDARS = ("lidar_vertical", "lidar_horizontal")
# What is moved half-way, by m and deg; nobody in the first.
BUMPS = (None, ("lidar_horizontal", "0.02,2"), ("lidar_horizontal", "0.05,0.5"), ("lidar_vertical", "0.02,2"))


def rig_of_lidars(printed):
    """Of the built-in rig's YAML its lidars alone."""
    begin, end = printed.index("sensors:\n") + len("sensors:\n"), printed.index("\n# The upright lidar")
    sensors = [one for one in re.split(r"(?m)^(?=  \w+:)", printed[begin:end]) if one.strip().split(":")[0] in LIDARS]
    rig = printed[:begin] + "".join(one.rstrip() + "\n" for one in sensors)
    return rig.replace("reference: front_left", "reference: " + LIDARS[0]).replace("mars-mapper", "two-lidars")


def judged(context, folder, seed, bump):
    """The verdict of one visit, whether it says that a sensor moved, and by how many of its sigmas the pose is off."""
    session = folder / "visit"
    moved = ("--bump", bump[0], "--bump-by", bump[1]) if bump else ()
    context.run_json("rigcal", "simulate", folder.parent / "lidars.yaml", "--out", session, "--seed", seed, *moved, "--json")
    with Server(context, folder / "data") as server:
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        if pushed.returncode not in ANSWERED:
            raise RuntimeError("rigcal push: exit %d: %s" % (pushed.returncode, pushed.stderr.strip()[-300:]))
        verdict = json.loads(server.rigcal("show", "two-lidars", "--json").stdout)["document"]["verdict"]
        compared = json.loads(server.rigcal("compare", "two-lidars", "--poses", session / "truth.yaml", "--json").stdout)
    return verdict["level"], " was moved during the session" in verdict["why"], compared["worst_sigmas"]


def run(context):
    seeds = range(1, 7) if context.full else (1,)
    results = {bump: [] for bump in BUMPS}
    with context.folder() as name:
        whole = pathlib.Path(name)
        printed = subprocess.run([str(context.bin / "rigcal"), "simulate", "--print-rig", "mars-mapper"], capture_output=True, text=True, check=True).stdout
        (whole / "lidars.yaml").write_text(rig_of_lidars(printed))
        for seed in seeds:
            for number, bump in enumerate(BUMPS):
                folder = whole / ("%d-%d" % (seed, number))
                folder.mkdir()
                results[bump].append(judged(context, folder, seed, bump))
    still = results.pop(None)
    yield equal("lidars_alone_of_%d_moved_said" % len(still), sum(said for _, said, _ in still), 0)
    yield at_most("lidars_alone_worst_error_in_sigmas", max(sigmas for _, _, sigmas in still), 4.0)
    for bump, ones in results.items():
        title = "lidars_alone_%s_by_%s_of_%d" % (bump[0].split("_")[1], bump[1].replace(",", "_"), len(ones))
        yield equal(title + "_found", sum(said and level == "fail" for level, said, _ in ones), len(ones))
        yield info(title + "_error_in_sigmas", max(sigmas for _, _, sigmas in ones))
