"""Pose graphs of others, pushed as edges of one robot each over DDS, in file order and shuffled: our optimum by g2o's own
cost, and the revision's bytes in every order."""
import json
import pathlib
import statistics

from ..measure import at_most, equal, skip
from ..server import ANSWERED, Server
from .g2o_cost import g2o_cost

# name: (optimum of g2o's cost, allowed relative excess) as data/README.md has them.
FILES = {
    "tinyGrid3D": (6.727882, 1e-4),
    "smallGrid3D": (458.15378, 2e-4),
    "parking-garage": (1.238691, 1e-6),
    "sphere2500": (727.149667, 1e-6),
}
# Optima of the SE(3)-Log cost, and how many digits they are known to.
LOG_COST = {"tinyGrid3D": 6.778920, "smallGrid3D": 464.145115, "sphere2500": 727.285111}
# (data set, file, mode): figure of graph_bench, limit, unit, runs. One thread; the middle one of the runs counts.
SYNTHETIC_SET, SESYNC_SET = "posegraph_synthetic", "posegraph_sesync"
BUDGETS = [
    (SYNTHETIC_SET, "rig_12_59", "batch", "median_us", 70, 5),
    (SYNTHETIC_SET, "rig_12_59", "incremental", "median_us", 25, 15),
    (SYNTHETIC_SET, "rig_12_59", "incremental", "p99_us", 80, 15),
    (SYNTHETIC_SET, "rig_12_59", "marginals", "median_us", 80, 5),
    (SYNTHETIC_SET, "rand_100_600", "batch", "median_us", 2500, 5),
    (SYNTHETIC_SET, "rand_100_600", "incremental", "median_us", 500, 5),
    (SYNTHETIC_SET, "rand_100_600", "incremental", "p99_us", 3500, 5),
    (SYNTHETIC_SET, "rand_1000_6000", "batch", "median_us", 40000, 3),
    (SESYNC_SET, "sphere2500", "batch", "median_us", 300000, 3),
    (SESYNC_SET, "parking-garage", "batch", "median_us", 100000, 3),
    (SESYNC_SET, "sphere2500", "incremental", "total_ms", 22000, 1),
    # Influence and loops, beside the solution: what a revision takes longer. Large graphs are bounded.
    (SYNTHETIC_SET, "rig_12_59", "insight", "cpu_median_us", 3000, 3),
    (SESYNC_SET, "sphere2500", "insight", "cpu_median_us", 30000, 3),
]
SYNTHETIC = {"k4_4_6": 19.098197, "rig_12_59": 308.578341, "rand_100_600": 3129.009235}


def pushed(server, path, robot, *extra):
    done = server.rigcal("push-edges", path, "--robot", robot, "--json", *extra)
    if done.returncode not in ANSWERED:
        raise RuntimeError("push-edges %s: exit %d: %s" % (path.name, done.returncode, done.stderr[-300:]))
    return json.loads(server.rigcal("show", robot, "--json").stdout)


def revisions_of(context, folder, path, name, orders):
    """The newest revision after pushing into an empty store, once per order."""
    for idx, extra in enumerate(orders):
        with Server(context, folder / ("%s-%d" % (name, idx))) as server:
            yield pushed(server, path, name, *extra)


def budgets(context):
    """Each promised time against its limit; files that are run for several figures are run once."""
    results = {}
    for folder, name, mode, figure, limit, runs in BUDGETS:
        key = (folder, name, mode)
        if key not in results:
            path = context.data / folder / (name + ".g2o")
            results[key] = [context.run_json("graph_bench", "--g2o", path, "--mode", mode) for _ in range(runs)]
        value = statistics.median(one[figure] for one in results[key])
        yield at_most("%s_%s_%s" % (name, mode, figure), value, limit, figure.rsplit("_", 1)[1])
        if name in LOG_COST and mode == "incremental":
            excess = max(one["cost_g2o"] for one in results[key]) / FILES[name][0] - 1.0
            yield at_most("%s_%s_g2o_excess" % (name, mode), excess, 1e-6)


def run(context):
    base = context.data / "posegraph_sesync"
    synthetic = context.data / "posegraph_synthetic"
    if not base.is_dir():
        yield skip("posegraph_sesync", "no data")
        return
    orders = [[], ["--shuffle", "1"], ["--shuffle", "2"]]
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        for name, (optimum, excess) in FILES.items():
            path = base / (name + ".g2o")
            shown = list(revisions_of(context, folder, path, name, orders))
            cost = g2o_cost(path, shown[0]["document"])
            yield at_most(name + "_g2o_excess", cost / optimum - 1.0, excess)
            if name in LOG_COST:
                yield at_most(name + "_log_cost_error", abs(shown[0]["document"]["cost"] / LOG_COST[name] - 1.0), 1e-6)
            yield equal(name + "_revisions_that_differ", len({one["digest"] for one in shown}) - 1, 0)
        for name, optimum in SYNTHETIC.items():
            result = context.run_json("graph_bench", "--g2o", synthetic / (name + ".g2o"))
            yield at_most(name + "_log_cost_error", abs(result["cost"] / optimum - 1.0), 1e-6)
        yield from budgets(context)
