"""A fisheye camera and a VLP-16 on real captures: whole clouds, no nominal poses, the service's own answer."""
import json
import math
import pathlib

from ..measure import at_least, at_most, info, skip
from ..rotations import of_rpy
from ..server import ANSWERED, Server
from . import acfr_session

# calibration_quickstart.csv: the median of its 50 runs.
AUTHOR_RPY_RAD = (-1.6954, -0.0208, -1.4933)
AUTHOR_MM = (63.0, 4.0, -196.0)


def angle_deg(rpy_a, rpy_b):
    a, b = of_rpy(rpy_a), of_rpy(rpy_b)
    trace = sum(a[i][k] * b[i][k] for i in range(3) for k in range(3))
    return math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1) / 2))))


def through_the_service(context, temporary, session):
    """The edge's method, state and number of captures, of the same folder pushed to a real rigcald."""
    with Server(context, pathlib.Path(temporary) / "store") as server:
        if server.rigcal("push", session, "--new-robot").returncode not in ANSWERED:
            raise RuntimeError("push failed")
        done = server.rigcal("show", "acfr", "--json")
        return [edge for edge in json.loads(done.stdout)["document"]["edges"] if edge["method"] == "lidar_camera"]


def run(context):
    source = context.data / "lidarcam_acfr_vlp16"
    if not source.is_dir():
        yield skip("lidarcam_acfr_vlp16", "no data")
        return
    with context.folder() as temporary:
        session, points = pathlib.Path(temporary) / "session", pathlib.Path(temporary) / "points"
        acfr_session.make(source, session)
        acfr_session.copy_board_points(source, points)
        result = context.run_json("lidar_camera_measure", session, points)
        edges = through_the_service(context, temporary, session)
    yield at_least("board_found_in_clouds", result["in_clouds"], 18)
    yield at_least("captures_used", result["used"], 18)
    yield at_least("planes_within_2deg_20mm", result["patches_near"], 18)
    yield info("worst_plane", result["worst_patch_deg"], "deg")
    yield info("worst_plane_offset", result["worst_patch_mm"], "mm")
    yield at_most("rotation_from_author", angle_deg(result["T_lidar_cam_rpy_rad"], AUTHOR_RPY_RAD), 0.5, "deg")
    yield at_most("translation_from_author", math.dist(result["T_lidar_cam_mm"], AUTHOR_MM), 30.0, "mm")
    ratio = result["halves_max_sigma_ratio"]
    yield at_most("halves_sigma_ratio", ratio if ratio >= 0 else math.inf, 3.0)  # below zero: a half gave no edge
    yield at_most("start_off_10deg_20cm_moves", result["start_shift_mm"], 0.1, "mm")
    yield at_most("start_off_10deg_20cm_turns", result["start_shift_deg"], 0.01, "deg")
    yield info("sigma", max(result["sigma_mm"]), "mm")
    yield info("plane_distance_rms", result["rms_mm"], "mm")
    yield at_least("edges_of_the_service", sum(edge["state"] == "good" for edge in edges), 1)
    yield info("detect_20_captures", result["detect_ms"], "ms")
    yield info("estimate_and_jackknife", result["edge_ms"], "ms")
