"""Is the graph as sure as it says? Scatter against stated covariance, for known and for estimated information."""
from ..measure import at_most, equal, info, within


def run(context):
    result = context.run_json("graph_honesty_measure")
    for kind in ("isotropic", "anisotropic", "deficient"):
        yield equal("nees_%s_outside_99" % kind, result["nees_%s_outside" % kind], 0)
        yield info("nees_%s_worst_mean" % kind, result["nees_%s_worst" % kind])
    yield within("sums_k4", result["sums_k4"], 0.5, 0.02)
    yield within("sums_12_59", result["sums_12_59"], 0.186, 0.01)
    for name in ("k4", "12_59"):
        yield at_most("sums_%s_largest" % name, result["sums_%s_largest" % name], 1.0)
    for blocks in (13, 20, 40):
        yield within("t2_coverage_%d_blocks" % blocks, result["t2_%d_coverage" % blocks], 0.95, 0.03)
        yield info("t2_residual_coverage_%d_blocks" % blocks, result["t2_%d_residuals" % blocks])
        yield info("honest_sigma_ratio_%d_blocks" % blocks, result["t2_%d_sigma_ratio" % blocks])
        yield at_most("t2_as_independent_%d_blocks" % blocks, result["t2_%d_independent" % blocks], 0.92)
        yield info("t2_as_independent_same_limit_%d_blocks" % blocks, result["t2_%d_independent_same_limit" % blocks])
