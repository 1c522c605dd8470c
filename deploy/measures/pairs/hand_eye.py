"""Two sensors on one body: real robots, trackers and visual-inertial sensors, and simulated motion with known truth."""
import math
import pathlib
import subprocess
import sys

from ..measure import at_least, at_most, equal, info, skip
from ..rotations import back, of_vector, times, turned
from . import hand_eye_sessions as sessions

# Values that came with the recordings, or were computed once with other tools (shared/data/README.md).
VISP_MM, VISP_RVEC = (57.715, -33.925, -42.277), (0.00178, 0.00917, 1.58178)
# Camera in the base: with the recording's lens held, and what its authors started from (the data's README).
CELL_MM, CELL_Q = (-18.6, 1268.7, 285.8), (0.04886, 0.55710, -0.82864, 0.02467)
CELL_GUESS_MM = (-19.6, 1278.4, 284.0)
VICON_MM, VICON_RVEC, VICON_OFFSET_S = (72.4, 45.9, 26.2), (-0.970, 0.845, -1.319), 0.024


def angle_between_deg(rvec_a, rvec_b):
    a, b = of_vector(rvec_a), of_vector(rvec_b)
    return math.degrees(2 * math.acos(min(1.0, abs(sum(x * y for x, y in zip(a, b))))))


def rotation_error_rad(result, rvec):
    """Log(R_result^T R_rvec): about the axes of b, as the sigmas are."""
    q = of_vector(result["T_a_b_rvec"])
    d = times(back(q), of_vector(rvec))
    d = d if d[3] >= 0 else [-v for v in d]
    norm = math.sqrt(sum(v * v for v in d[:3]))
    scale = 2 * math.atan2(norm, d[3]) / norm if norm > 0 else 2.0
    return [scale * v for v in d[:3]]


def worst_sigmas(result, mm, rvec):
    """Largest error over sigma, along and about the axes of b."""
    q = of_vector(result["T_a_b_rvec"])
    along = turned(back(q), [m - t for m, t in zip(mm, result["T_a_b_mm"])])
    about = [math.degrees(v) for v in rotation_error_rad(result, rvec)]
    return max(abs(e) / s for e, s in zip(along + about, result["sigma_mm"] + result["sigma_deg"]))


def composed(first, second):
    q = of_vector(first["T_a_b_rvec"])
    mm = [a + b for a, b in zip(first["T_a_b_mm"], turned(q, second["T_a_b_mm"]))]
    return mm, times(q, of_vector(second["T_a_b_rvec"]))


def of_visp(context, temporary):
    source = context.data / "handeye_visp_franka" / "data-eye-in-hand"
    if not source.is_dir():
        yield skip("handeye_visp_franka", "no data")
        return
    sessions.make_visp(source, temporary / "visp")
    result = context.run_json("hand_eye_measure", temporary / "visp", "flange", "camera")
    yield at_most("visp_closed_form_from_author", math.dist(result["closed_form_mm"], VISP_MM), 0.3, "mm")
    yield at_most("visp_closed_form_turned", angle_between_deg(result["closed_form_rvec"], VISP_RVEC), 0.05, "deg")
    yield at_most("visp_refined_from_author", math.dist(result["T_a_b_mm"], VISP_MM), 5.0, "mm")
    yield at_most("visp_refined_turned", angle_between_deg(result["T_a_b_rvec"], VISP_RVEC), 0.6, "deg")
    yield at_most("visp_refined_sigmas", worst_sigmas(result, VISP_MM, VISP_RVEC), 3.0)


def of_asl(context, temporary):
    if not (context.data / "handeye_asl").is_dir():
        yield skip("handeye_asl", "no data")
        return
    sessions.make_streams(sessions.vicon(context.data), temporary / "vicon")
    vicon = context.run_json("hand_eye_measure", temporary / "vicon", "body", "camera")
    yield at_most("vicon_translation_from_check", math.dist(vicon["T_a_b_mm"], VICON_MM), 10.0, "mm")
    yield at_most("vicon_rotation_from_check", angle_between_deg(vicon["T_a_b_rvec"], VICON_RVEC), 1.0, "deg")
    yield at_most("vicon_offset_from_check", 1e3 * abs(vicon["clock_offset_s"] - VICON_OFFSET_S), 5.0, "ms")
    yield info("vicon_offset_sigma", 1e3 * vicon["clock_offset_sigma_s"], "ms")
    sessions.make_streams(sessions.tango(context.data), temporary / "tango")
    edges = {(a, b): context.run_json("hand_eye_measure", temporary / "tango", a, b)
             for a, b in (("caligula", "mars"), ("mars", "nero"), ("caligula", "nero"))}
    yield equal("tango_edges", sum(edge["state"] == "good" for edge in edges.values()), 3)
    mm, q = composed(edges["caligula", "mars"], edges["mars", "nero"])
    direct = edges["caligula", "nero"]
    yield at_most("tango_loop_closes", math.dist(mm, direct["T_a_b_mm"]), 15.0, "mm")
    same = abs(sum(x * y for x, y in zip(q, of_vector(direct["T_a_b_rvec"]))))
    yield at_most("tango_loop_turned", math.degrees(2 * math.acos(min(1.0, same))), 0.3, "deg")
    yield info("streams_to_edge", vicon["edge_ms"], "ms")


def of_cell(context, temporary):
    """A camera beside a robot with a board on its wrist."""
    source = context.data / "handeye_robot_cal_tools" / "test_set_charuco"
    if not source.is_dir():
        yield skip("handeye_robot_cal_tools", "no data")
        return
    for lens in ("given", "estimated"):
        folder = temporary / ("cell_" + lens)
        subprocess.run([sys.executable, str(context.root / "tests" / "data" / "extract_robot_cal_tools.py"), str(source),
                        str(folder), "--lens", lens], check=True)
        result = context.run_json("hand_eye_measure", folder, "arm", "camera")
        yield equal("eye_to_hand_%s_lens_method" % lens, result["method"], "eye_to_hand")
        yield at_most("eye_to_hand_%s_lens_from_check" % lens, math.dist(result["T_a_b_mm"], CELL_MM), 10.0, "mm")
        yield info("eye_to_hand_%s_lens_from_authors_guess" % lens, math.dist(result["T_a_b_mm"], CELL_GUESS_MM), "mm")
        same = abs(sum(x * y for x, y in zip(of_vector(result["T_a_b_rvec"]), CELL_Q)))
        turned_deg = math.degrees(2 * math.acos(min(1.0, same)))
        if lens == "given":  # the check's turn is of the same lens
            yield at_most("eye_to_hand_given_lens_turned", turned_deg, 0.5, "deg")
        else:
            yield info("eye_to_hand_estimated_lens_turned", turned_deg, "deg")
        yield info("eye_to_hand_%s_lens_sigma" % lens, max(result["sigma_mm"]), "mm")
        yield info("eye_to_hand_%s_lens_rms" % lens, result["rms_px"], "px")


def of_cell_truth(context):
    seeds = 200 if context.full else 50
    result = context.run_json("eye_to_hand_simulation", seeds, timeout=3000)
    for name in ("given", "estimated"):
        cell = result[name]
        yield equal("eye_to_hand_%s_failed" % name, cell["failed"], 0)
        yield at_least("eye_to_hand_%s_covered" % name, cell["covered_ratio"], 0.8)
        yield at_most("eye_to_hand_%s_rms_over_bound" % name, cell["rms_mm"] / cell["bound_mm"], 1.5)
        yield at_most("eye_to_hand_%s_rms_over_bound_turned" % name, cell["rms_deg"] / cell["bound_deg"], 1.5)
    for name in ("one_axis", "first_joint", "no_turns"):
        yield equal("eye_to_hand_%s_other_rank" % name, result[name]["other_rank"], 0)
        yield at_most("eye_to_hand_%s_sigmas" % name, result[name]["worst_sigmas"], 5.0)


def of_weak_motion(name, cases):
    for case in cases:
        title = "%s_tilt_over_noise_%g" % (name, case["ratio"])
        yield at_most(title + "_sigmas", case["worst_sigmas"], 4.0)
        yield at_most(title + "_axis", case["axis_deg"], 2.0, "deg")
        yield equal(title + "_failed", case["failed"], 0)
        yield info(title + "_ranks", "4:%d_5:%d_6:%d" % (case["rank4"], case["rank5"], case["rank6"]))


def of_truth(context):
    result = context.run_json("hand_eye_simulation", 160 if context.full else 24, timeout=3000)
    for name in ("planar", "on_the_spot"):
        yield from of_weak_motion(name, result[name])
    for name in ("two_trackers", "tracker_camera", "two_cameras_given", "two_cameras_estimated", "streams"):
        yield equal(name + "_failed", result[name]["failed"], 0)
        yield info(name + "_rms", result[name]["rms_mm"], "mm")
        yield info(name + "_covered", result[name]["covered_ratio"])
        if result[name]["bound_mm"] > 0:
            yield at_most(name + "_rms_over_bound", result[name]["rms_mm"] / result[name]["bound_mm"], 1.5)
            yield at_most(name + "_rms_over_bound_turned", result[name]["rms_deg"] / result[name]["bound_deg"], 1.5)
    yield at_most("turned_views_move_the_result", result["turned"]["moved_mm"], 0.01, "mm")
    yield at_most("turned_views_turn_the_result", result["turned"]["moved_deg"], 0.001, "deg")
    yield equal("turned_or_small_boards_failed", result["turned"]["failed"], 0)
    yield at_most("small_frontal_boards_sigmas", result["turned"]["small_worst_sigmas"], 4.0)
    yield at_most("clock_offset", result["offset_worst_ms"], 1.0, "ms")
    yield at_most("clock_offset_sigmas", result["offset_worst_sigmas"], 4.0)
    yield info("simulation", result["seconds"], "s")


def run(context):
    with context.folder() as folder:
        temporary = pathlib.Path(folder)
        yield from of_visp(context, temporary)
        yield from of_asl(context, temporary)
        yield from of_cell(context, temporary)
    yield from of_truth(context)
    yield from of_cell_truth(context)
