"""Two cameras that look outwards before two boards: each sees another board most of the time, and both see both. All that they see in common is to be
judged as a whole. Whole sessions of pictures, from files to the verdict."""
import json
import pathlib

from ..measure import at_least, at_most, equal
from ..server import ANSWERED, Server

RIG = """format: 1
name: two-boards
robot: two-boards
reference: left
nominal_sigma_m: 0.01
nominal_sigma_deg: 1
motion: {captures: 40, start_m: [0, 0, 1], position_range_m: [0.3, 0.3, 0.1], yaw_range_deg: 9, tilt_rms_deg: 5}
boards:
  wide: {inner_corners: [10, 7], square_size_m: 0.06, plate_size_m: [0.75, 0.56], T_world_plate: {p_m: [2.0, 0.55, 1.0], rpy_deg: [3, 8, 10]}}
  tall: {inner_corners: [6, 9], square_size_m: 0.06, plate_size_m: [0.5, 0.68], T_world_plate: {p_m: [2.0, -0.55, 1.0], rpy_deg: [-3, 6, -12]}}
room: {size_m: [7.4, 7.4, 4.4], patches_per_wall: 16}
camera: {size_px: [1280, 960], blur_px: 0.7, noise_grey: 2, corner_sigma_px: 0.03}
sensors:
  left:
    {type: camera, T_body_sensor: {p_m: [0.300, 0.150, 0.002], rpy_deg: [0.3, 0.4, 12.5]},
     lens: {fx_px: 860.3, fy_px: 861.6, cx_px: 641.4, cy_px: 482.7, distortion: [-0.0812, 0.0731, 0.00032, -0.00021, -0.0112]}}
  right:
    {type: camera, T_body_sensor: {p_m: [0.301, -0.151, -0.001], rpy_deg: [-0.4, 0.2, -12.6]},
     lens: {fx_px: 858.9, fy_px: 858.4, cx_px: 638.2, cy_px: 477.9, distortion: [-0.0795, 0.0702, -0.00018, 0.00041, -0.0098]}}
"""
# What the right one is moved by half-way, by m and deg; not at all in the first.
BUMPS = (None, "0.02,2", "0.005,0.5", "0.002,0.2")


def judged(context, folder, seed, bump):
    """Whether the session was refined as a whole, whether the right camera is said to have moved, the verdict, and by how many sigmas its pose is off."""
    session = folder / "visit"
    moved = ("--bump", "right", "--bump-by", bump) if bump else ()
    context.run_json("rigcal", "simulate", folder.parent / "rig.yaml", "--out", session, "--seed", seed, *moved, "--json")
    with Server(context, folder / "data") as server:
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        if pushed.returncode not in ANSWERED:
            raise RuntimeError("rigcal push: exit %d: %s" % (pushed.returncode, pushed.stderr.strip()[-300:]))
        document = json.loads(server.rigcal("show", "two-boards", "--json").stdout)["document"]
        compared = json.loads(server.rigcal("compare", "two-boards", "--poses", session / "truth.yaml", "--json").stdout)
    verdict = document["verdict"]
    return {"refined": "right" in document.get("fused", {}).get("sensors", []), "said": "was moved during the session" in verdict["why"],
            "level": verdict["level"], "sigmas": compared.get("worst_sigmas")}


def run(context):
    seeds = range(1, 6 if context.full else 2)
    results = {bump: [] for bump in BUMPS}
    with context.folder() as name:
        whole = pathlib.Path(name)
        (whole / "rig.yaml").write_text(RIG)
        for seed in seeds:
            for number, bump in enumerate(BUMPS):
                folder = whole / ("%d-%d" % (seed, number))
                folder.mkdir()
                results[bump].append(judged(context, folder, seed, bump))
    still = results.pop(None)
    yield equal("two_boards_of_%d_refined" % len(still), sum(one["refined"] for one in still), len(still))
    yield equal("two_boards_of_%d_moved_said" % len(still), sum(one["said"] for one in still), 0)
    yield at_most("two_boards_worst_error_in_sigmas", max(one["sigmas"] for one in still), 4.0)
    for bump, ones in results.items():
        yield at_least("two_boards_right_by_%s_of_%d_found" % (bump.replace(",", "_"), len(ones)),
                       sum(one["said"] and one["level"] == "fail" for one in ones), len(ones))
