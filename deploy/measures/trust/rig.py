"""The virtual MARS Mapper without a picture: noisy corners, plate points and tracker poses through every estimator and
the graph, against the Cramer-Rao bound of the whole rig."""
from ..measure import at_least, at_most, info


def run(context):
    seeds = 40 if context.full else 10
    result = context.run_json("rig_measure", "--edges", seeds, timeout=7200)
    yield at_least("good_edges_of_59", result["good_edges"], 59)
    for kind in ("cameras", "lidars", "all_but_tracker"):
        yield at_most(kind + "_rms_over_cramer_rao_translation", result[kind]["ratio_translation"], 1.5)
        yield at_most(kind + "_rms_over_cramer_rao_rotation", result[kind]["ratio_rotation"], 1.5)
        yield info(kind + "_mean_square_in_sigmas", result[kind]["mean_square"])
    for method in ("stereo", "non_overlapping", "lidar_camera", "tracker_camera"):
        edges = result["edge_" + method]
        yield info(method + "_rms_over_bound_of_pair", "%.2f_%.2f" % (edges["ratio_translation"], edges["ratio_rotation"]))
    peer = context.run_json("joint_peer", 10 if context.full else 3)
    yield at_most("session_optimum_over_that_of_ceres_time", peer["ours_s"] / min(peer["ceres_dense_schur_s"], peer["ceres_sparse_schur_s"]), 1.0)
    yield at_most("session_optimum_apart_from_that_of_ceres_in_sigmas", peer["apart_sigmas"], 1e-3)
    yield info("edges_of_a_rig", result["edges_s"], "s")
