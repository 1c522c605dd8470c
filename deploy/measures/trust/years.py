"""Years of weekly visits of robots one sensor of which does not stay where it was: creeping, to and fro with the seasons, or by a small step each
week. Does the region that a revision tells hold where each sensor sits on the next visit? tests/bench/fleet/years_measure.cc draws them."""
from ..measure import Measure, at_least, info, within

SEED = 20160104
QUICK, FULL = (2, 78), (12, 520)  # robots, weeks
QUARTER, DECADE = 13, 520  # weeks
# Name, scatter of every sensor from visit to visit, creep in 30 days, to and fro in a year, step from visit to visit: mm. With --full only.
WAYS = (
    ("steady", 0.0, 0.0, 0.0, 0.0, False),
    ("scatter_0.3_mm", 0.3, 0.0, 0.0, 0.0, False),
    ("creep_0.05_mm_a_month", 0.0, 0.05, 0.0, 0.0, True),
    ("creep_0.1_mm_a_month", 0.0, 0.1, 0.0, 0.0, False),
    ("creep_0.3_mm_a_month", 0.0, 0.3, 0.0, 0.0, False),
    ("creep_0.3_mm_a_month_scatter_0.3_mm", 0.3, 0.3, 0.0, 0.0, False),
    ("creep_1_mm_a_month", 0.0, 1.0, 0.0, 0.0, True),
    ("season_0.2_mm", 0.0, 0.0, 0.2, 0.0, True),
    ("season_0.5_mm", 0.0, 0.0, 0.5, 0.0, False),
    ("season_1_mm_scatter_0.3_mm", 0.3, 0.0, 1.0, 0.0, True),
    ("steps_0.05_mm", 0.0, 0.0, 0.0, 0.05, False),
    ("steps_0.2_mm", 0.0, 0.0, 0.0, 0.2, True),
)


def rows_of(name, figures):
    said_moved = 100.0 * figures["said_moved"] / figures["revisions"]
    yield info(name + "_said_moved_percent", said_moved)
    for which, least in (("moving", 90.0), ("others", 92.0), ("early", 90.0)):
        regions = figures[which]
        if regions["count"] == 0:  # none is relied on, if each says that a sensor was moved
            yield Measure(name + "_%s_inside_percent" % which, "none_told", "-", "ok" if said_moved > 90 else "SHORT")
            continue
        inside = 100.0 * regions["inside"] / regions["count"]
        detail = ["mean T^2 %.2f, off by %.3f mm, sigma %.3f mm" % (regions["mean_t2"], regions["error_mm"], regions["sigma_mm"])]
        if which == "others" and name == "scatter_0.3_mm":
            yield within(name + "_others_inside_percent", inside, 95.0, 3.0)
        else:
            yield at_least(name + "_%s_inside_percent" % which, inside, least, detail=detail)
        if regions["endless"]:
            yield info(name + "_%s_without_a_region_percent" % which, 100.0 * regions["endless"] / (regions["endless"] + regions["count"]))
        yield info(name + "_%s_error_over_sigma" % which, regions["error_mm"] / regions["sigma_mm"])


def run(context):
    robots, weeks = FULL if context.full else QUICK
    for name, scatter, creep, season, step, full_only in WAYS:
        if full_only and not context.full:
            continue
        yield from rows_of(name, context.run_json("years_measure", robots, weeks, SEED, scatter, creep, season, step, timeout=20000))
    yield from rows_of("creep_0.1_mm_a_month_visits_each_quarter",
                       context.run_json("years_measure", robots, DECADE, SEED, 0.0, 0.1, 0.0, 0.0, QUARTER, timeout=20000))
