"""A lidar and a tracker on one body before boards that stand still: plates with known truth, the virtual MARS Mapper at feature
level, and whole visits to it through the service."""
import pathlib

from ..chance import by_chance
from ..measure import at_least, at_most, equal, info
from ..server import Server
from . import tracker_lidar_sessions as sessions

VISITS_OPTIONS = ("--captures", "30")
VISITS = 8  # the rms of three has a standard deviation of a quarter of itself


def of_weak_motion(name, cases):
    for case in cases:
        title = "%s_tilt_over_noise_%g" % (name, case["ratio"])
        yield at_most(title + "_sigmas", case["worst_sigmas"], 4.0)  # in principal directions of the estimated information
        yield at_most(title + "_axis_sigmas", case["worst_axis_sigmas"], 4.0)  # along and about the axes whose sigma is told
        yield at_most(title + "_axis", case["axis_deg"], 2.0, "deg")
        yield equal(title + "_failed", case["failed"], 0)
        yield info(title + "_ranks", "4:%d_5:%d_6:%d" % (case["rank4"], case["rank5"], case["rank6"]))


def of_estimates(name, result):
    yield equal(name + "_failed", result["failed"], 0)
    yield at_most(name + "_rms_over_cramer_rao_translation", result["rms_mm"] / result["bound_mm"], 1.5)
    yield at_most(name + "_rms_over_cramer_rao_rotation", result["rms_deg"] / result["bound_deg"], 1.5)
    yield info(name + "_rms", result["rms_mm"], "mm")
    yield info(name + "_rms_turned", result["rms_deg"], "deg")
    yield info(name + "_mean_square_in_sigmas", result["mean_square"])
    # Of 95 % regions; 0.8 is 5 sigma below at 24 seeds.
    yield at_least(name + "_covered", result["covered_ratio"], 0.8)


def of_truth(context):
    seeds = 80 if context.full else 24
    result = context.run_json("tracker_lidar_simulation", seeds, timeout=3000)
    for name in ("general",) + sessions.LIDARS:
        yield from of_estimates(name, result[name])
    yield at_most("exact_poses_error", result["exact_error"], 1e-6)
    yield equal("without_nominal_failed", result["without_nominal"]["count"] - result["without_nominal"]["good"], 0)
    for name, rank in (("planar", 5), ("on_the_spot", 4)):
        yield from by_chance(context, name, 40, rank, seeds)
        yield from of_weak_motion(name, result[name])
    yield info("pair", result["pair_ms"], "ms")
    yield info("pair_without_nominal", result["without_nominal"]["pair_ms"], "ms")
    yield info("simulation", result["seconds"], "s")


def of_visits(context, folder, lidar):
    worst, squares, bounds = 0.0, [], []
    for seed in range(1, VISITS + 1):
        visit, bound = sessions.simulate(context, folder, lidar, seed, *VISITS_OPTIONS)
        with Server(context, folder / ("data-" + visit.name)) as server:
            server.rigcal("push", visit, "--new-robot")
            edge, error = sessions.edge_of(server, visit), sessions.error_of(server, visit)
        worst = max([worst] + [abs(e) / s for e, s in zip(error["e"], edge["sigma_m"] + edge["sigma_rad"])])
        squares.append(sum(e * e for e in error["e"][:3]))
        bounds.append(sum(b * b for b in bound[:3]))
    yield at_most(lidar + "_visits_worst_sigmas", worst, 4.0)
    for title, count in (("_first_three_visits", 3), ("_visits", VISITS)):
        ratio = (sum(squares[:count]) / sum(bounds[:count])) ** 0.5
        yield at_most(lidar + title + "_rms_over_cramer_rao_translation", ratio, 1.5)
    yield info(lidar + "_visits_rms", 1e3 * (sum(squares) / VISITS) ** 0.5, "mm")


def run(context):
    yield from of_truth(context)
    with context.folder() as name:
        for lidar in sessions.LIDARS:
            yield from of_visits(context, pathlib.Path(name), lidar)
