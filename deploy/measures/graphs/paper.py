"""The paper's experiments on simulated truth; the page is written to build/measure/paper/index.html."""
import math

from ..measure import at_least, at_most, equal, info, within


def between(name, value, interval):
    """Within an interval that theory gives for odds of 1e-6."""
    low, high = interval
    return within(name, value, (low + high) / 2, (high - low) / 2)


def noise_rows(noise):
    yield equal("noise_sets", noise["sets"], 300)
    yield within("whitened_ratio", noise["whitened_ratio"], 0.5, 0.02)
    yield at_most("whitened_ratio_largest", noise["whitened_ratio_largest"], 1.0)
    for part in ("translation", "rotation"):
        predicted = noise[part + "_ratio_predicted"]
        yield within(part + "_ratio", noise[part + "_ratio"], predicted, 0.03)


def global_rows(mars):
    """(b): E_global against the linear prediction; weighted noise against degrees of freedom."""
    yield equal("mars_edges", mars["edges_min"], 59)
    for errors in ("visits", "realistic", "paper_noise"):
        for information in ("full", "diagonal"):
            run = mars[errors][information]
            name = "mars_%s_%s_" % (errors, information)
            for when in ("before", "after"):
                yield between(name + when + "_over_predicted", run[when] / run[when + "_predicted"], run[when + "_over_predicted_interval"])
            yield info(name + "after_over_before", run["after"] / run["before"])
    for errors in ("realistic", "paper_noise"):
        full, diagonal = mars[errors]["full"], mars[errors]["diagonal"]
        yield between("mars_%s_cost_over_dof" % errors, full["cost"] / mars["dof"], mars["cost_over_dof_interval"])
        yield within("mars_%s_whitened_ratio" % errors, full["whitened_ratio"], mars["whitened_ratio_expected"], mars["whitened_ratio_half_width"])
        # Gauss and Markov: no weights are better than the inverse covariances.
        for unit in ("m", "rad"):
            yield at_most("mars_%s_poses_full_over_diagonal_%s" % (errors, unit), full["poses_rms_" + unit] / diagonal["poses_rms_" + unit], 1.0)
    yield info("mars_noise_factor_of_the_paper", mars["noise_factor"])


def chain_rows(chain):
    """(c): the graph is no worse than what it is made of; every way errs as its covariance says."""
    for unit in ("m", "rad"):
        rms = {way: chain["all"][way]["rms_" + unit] for way in ("chained", "direct", "graph")}
        yield at_most("graph_over_chained_" + unit, rms["graph"] / rms["chained"], 1.0)
        yield at_most("graph_over_direct_" + unit, rms["graph"] / rms["direct"], 1.0)
        sums = chain["all"]["graph"]
        yield between("graph_square_over_predicted_" + unit, (rms["graph"] / sums["predicted_" + unit]) ** 2, sums["square_over_predicted_interval_" + unit])


def least_within_3_sigma(count):
    """Of so many normal errors with right sigmas, 99.7 % of which are within, the part that is, but for odds of 1e-6."""
    beyond = math.erfc(3 / math.sqrt(2))
    odds, number = 1.0, 0
    while odds > 1e-6:  # the odds that `number` or more are beyond
        odds -= math.comb(count, number) * beyond**number * (1 - beyond) ** (count - number)
        number += 1
    return (count - number + 1) / count


def method_rows(method):
    """(d): how far two methods differ, in sigmas of the difference."""
    for number, family in enumerate(method["families"], 1):
        yield at_least("methods_%d_within_3_sigma" % number, family["within_3_sigma_ratio"], least_within_3_sigma(family["differences"]))
        yield info("methods_%d_rms_in_sigmas" % number, family["rms_sigmas"])


def run(context):
    folder = context.root / "build" / "measure" / "paper"
    folder.parent.mkdir(parents=True, exist_ok=True)
    figures = context.run_json("paper_experiment", "--out", folder, "--threads", 2, timeout=1800)
    yield from noise_rows(figures["noise"])
    yield from global_rows(figures["global"])
    yield from chain_rows(figures["chain"])
    yield from method_rows(figures["method"])
    yield info("page", (folder / "index.html").relative_to(context.root))
