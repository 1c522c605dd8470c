"""Two lidars on real clouds: NDT, its polish and its speed against the values published or checked with the data; and in a
virtual room, on captures that the pose was not made from."""
import math

from ..measure import at_least, at_most, equal, info, skip
from ..rotations import matrix_of, of_rpy

# T_target_source.txt of lidarlidar_small_gicp: a generalised ICP's result.
SMALL_GICP = [[0.999925, 0.0121483, -0.00177009], [-0.0121523, 0.999924, -0.00228657], [0.00174218, 0.00230791, 0.999996]]
SMALL_GICP_T_M = (0.488882, 0.121214, -0.0253342)
# lidarlidar_opencalib/0001: nominal yaw; reference roll, pitch, yaw and translation.
SIDES = {"left": (90, (-4.2, 45.1, 91.9), (0.01, 0.58, -0.40)), "right": (-90, (-0.5, 45.8, -86.2), (-0.03, -0.56, -0.43))}


def angle_deg(a, b):
    # By the skew part: near zero the trace knows nothing.
    r = [[sum(a[k][i] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    sine = math.hypot(r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]) / 2
    return math.degrees(math.atan2(sine, (sum(r[i][i] for i in range(3)) - 1) / 2))


def off(pose, rotation, t_m):
    """Millimetres and degrees."""
    return 1e3 * math.dist(pose["t_m"], t_m), angle_deg(matrix_of(pose["q_xyzw"]), rotation)


def small_gicp(context, folder):
    result = context.run_json("lidar_lidar_measure", folder / "target.ply", folder / "source.ply", 0, 0, 0, 0, 0, 0, 21)
    for name, pose, limit_mm, limit_deg in (("ndt", "T_ndt", 25, 0.35), ("polished", "T_polished", 15, 0.15)):
        mm, deg = off(result[pose], SMALL_GICP, SMALL_GICP_T_M)
        yield at_most("small_gicp_%s_from_author" % name, mm, limit_mm, "mm")
        yield at_most("small_gicp_%s_turned_from_author" % name, deg, limit_deg, "deg")
    yield at_most("small_gicp_last_step", result["ndt_last_step"], 1e-4)
    # What is timed is NDT alone, from the nominal pose: judged as the whole edge's answer is.
    mm, deg = off(result["T_ndt_from_nominal"], SMALL_GICP, SMALL_GICP_T_M)
    yield at_most("small_gicp_timed_ndt_from_author", mm, 25, "mm")
    yield at_most("small_gicp_timed_ndt_turned_from_author", deg, 0.35, "deg")
    yield at_most("ndt_two_threads", result["ndt_ms"], 60, "ms")
    yield info("ndt_one_thread", result["ndt_one_thread_ms"], "ms")
    yield at_least("same_bits_from_one_and_two_threads", int(result["same_bits"]), 1)
    yield info("edge_with_starts_and_checks", result["edge_ms"], "ms")
    yield from checks("small_gicp_other_half", result, "held_out_halves_")


def opencalib(context, folder):
    for side, (yaw_deg, rpy_deg, t_m) in SIDES.items():
        result = context.run_json("lidar_lidar_measure", folder / "top.pcd", folder / (side + ".pcd"), 0, 45, yaw_deg,
                                  0, 0, 0, 3)
        yield at_least("opencalib_%s_good" % side, int(result["ndt_good"]), 1)
        for pose in ("ndt", "polished"):
            mm, deg = off(result["T_" + pose], of_rpy(map(math.radians, rpy_deg)), t_m)
            yield at_most("opencalib_%s_%s" % (side, pose), mm, 50, "mm")
            yield at_most("opencalib_%s_%s_turned" % (side, pose), deg, 0.5, "deg")
        yield info("opencalib_%s_sigma" % side, 1e3 * max(result["sigma"][:3]), "mm")


def checks(name, figures, held_out):
    """D (1, or the angle 0: the normals agree) and E_l of surfaces that the pose was not made from."""
    yield info(name + "_D", figures[held_out + "D_ratio"])
    yield info(name + "_D_angle", math.degrees(figures[held_out + "D_angle_rad"]), "deg")
    yield info(name + "_E_l", 1e3 * figures[held_out + "E_l_m"], "mm")
    yield info(name + "_E_l_rms", 1e3 * figures[held_out + "E_l_rms_m"], "mm")


def room(context):
    """E_l is the pose's error across surfaces: 3 mm, as the estimator's tests have it; its rms is the noise of a range
    (20 mm) at most, for a cell is several points; D is of normals that are as good as voxels of such points."""
    for seed in range(1, 11 if context.full else 4):
        result = context.run_json("lidar_lidar_room", 8, seed)
        for kind in ("ndt", "polished"):
            name, edge = "room_%d_%s" % (seed, kind), result[kind]
            yield at_least(name + "_good", int(edge["good"]), 1)
            if not edge["good"]:
                continue
            held_out = "held_out_captures_"
            yield at_least(name + "_left_out_D", edge[held_out + "D_ratio"], 0.99)
            yield info(name + "_left_out_D_angle", math.degrees(edge[held_out + "D_angle_rad"]), "deg")
            yield at_most(name + "_left_out_E_l", 1e3 * edge[held_out + "E_l_m"], 3, "mm")
            yield at_most(name + "_left_out_E_l_rms", 1e3 * edge[held_out + "E_l_rms_m"], 1e3 * result["range_noise_m"], "mm")
            yield info(name + "_error", 1e3 * edge["error_m"], "mm")
            yield info(name + "_error_turned", math.degrees(edge["error_rad"]), "deg")
            yield at_most(name + "_error_in_sigmas", edge["worst_in_sigmas"], 4)


def one_capture(context):
    """Its uncertainty is a model's: of the distances between surfaces, at whose optimum the pose is, and of what two methods
    disagree by. Beside it NDT's own Hessian, at the optimum of NDT's finest level, and that optimum's error. What is told may
    be too wide, up to a sigma of three times the error, never too small."""
    seeds = 100 if context.full else 40
    for noise_mm in (2, 5, 20, 50):
        result = context.run_json("lidar_lidar_room", "--one-capture", noise_mm / 1e3, seeds)
        name, told, ndt = "one_capture_noise_%dmm" % noise_mm, result["told"], result["ndt_hessian"]
        yield at_least(name + "_solved", told["count"] / seeds, 0.9)
        yield equal(name + "_uncertainty_is_a_model", told["count"] - result["model"], 0)
        yield at_most(name + "_worst_sigmas", told["worst"], 4)
        yield at_most(name + "_mean_square_in_sigmas", told["mean_square"], 1)
        yield at_least(name + "_mean_square_in_sigmas_too_wide", told["mean_square"], 0.11)
        yield info(name + "_rms", 1e3 * told["rms_m"], "mm")
        yield info(name + "_ndt_rms", 1e3 * ndt["rms_m"], "mm")
        yield info(name + "_ndt_hessian_worst_sigmas", ndt["worst"])
        yield info(name + "_ndt_hessian_mean_square_in_sigmas", ndt["mean_square"])
        yield info(name + "_ndt_hessian_indefinite", told["count"] - ndt["count"])


def run(context):
    yield from room(context)
    yield from one_capture(context)
    for name, path, body in (("lidarlidar_small_gicp", "lidarlidar_small_gicp", small_gicp),
                             ("lidarlidar_opencalib", "lidarlidar_opencalib/0001", opencalib)):
        if (context.data / path).is_dir():
            yield from body(context, context.data / path)
        else:
            yield skip(name, "no data")
