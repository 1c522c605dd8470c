"""Does a fleet's history say who moved, and is it silent where nobody did? A drawn fleet through the server's as-found test, and real dated
calibrations of one rig.

Rows count sessions by how many visits stand behind the calibration in use, as few visits hardly tell what visits scatter by."""
import json
import math
import statistics
import subprocess

from ..measure import Measure, at_least, at_most, equal, info, skip, within
from ..rotations import composed, inverse

ALPHA = 1e-3  # of a session that accuses a sensor where nothing happened
GROUPS = ((1, 1, "1"), (2, 2, "2"), (3, 3, "3"), (4, 4, "4"), (5, 7, "5_to_7"), (8, 10 ** 6, "8_and_more"))
# Robots, weeks, sessions beside each one.
QUICK, FULL = (60, 26, 4), (1000, 52, 1)
ALONE = (12, 12, 20)
SEED = 20160104


def most_by_chance(count, odds, tail=0.005):
    """The upper end of the binomial interval of 99 %."""
    chance = math.exp(count * math.log1p(-odds))
    total, most = chance, 0
    while total < 1 - tail:
        chance *= (count - most) / (most + 1) * odds / (1 - odds)
        total, most = total + chance, most + 1
    return most


def summed(by_visits, first, last):
    """Of the counts of all numbers of visits from first to last; means by sessions."""
    taken = [one for visits, one in by_visits.items() if first <= int(visits) <= last]
    total = {key: sum(one[key] for one in taken) for key in (taken[0] if taken else ())}
    sessions = max(1, total.get("sessions", 0))
    for key in ("smallest_mm", "smallest_deg"):
        if key in total:
            total[key] = sum(one[key] * one["sessions"] for one in taken) / sessions
    return total


def false_alarms(name, counts):
    most = most_by_chance(counts["sessions"], ALPHA)
    return Measure(name, "%d_of_%d" % (counts["accused"], counts["sessions"]), "<=%d" % most, "ok" if counts["accused"] <= most else "SHORT")


def quiet_rows(prefix, quiet):
    for first, last, name in GROUPS:
        counts = summed(quiet, first, last)
        if counts:
            yield false_alarms(prefix + "false_alarms_visits_" + name, counts)
    counts = summed(quiet, 1, 10 ** 6)
    yield false_alarms(prefix + "false_alarms", counts)
    yield info(prefix + "false_alarms_a_year_of_1000_robots", 52000.0 * counts["accused"] / max(1, counts["sessions"]))


def told_moved_rows(prefix, tally):
    """Revisions that say that a sensor was moved between two visits, or warn that it sat elsewhere on one, of robots to which nothing happened.
    A revision compares up to eight visits."""
    for key, what in (("told_moved", "falsely_moved"), ("told_apart", "falsely_apart")):
        for first, last, name in ((2, 2, "2"),) + GROUPS[2:]:
            counts = summed(tally[key], first, last)
            if counts:
                yield false_alarms(prefix + what + "_visits_" + name, counts)
    counts = summed(tally["remarks_apart"], 2, 2)
    if counts:
        yield info(prefix + "passes_that_remark_on_apart_visits_2", "%d_of_%d" % (counts["accused"], counts["sessions"]))


def event_rows(prefix, events):
    for first, last, name in GROUPS:
        least, more = summed(events["1.0"], first, last), summed(events["1.2"], first, last)
        if not least or not more:
            continue
        tail = "_visits_" + name
        yield within(prefix + "smallest_change_found" + tail, least["found"] / least["sessions"], 0.95, 0.02)
        yield info(prefix + "smallest_change_found_with_the_right_sensor" + tail, least["named"] / least["sessions"])
        yield at_least(prefix + "1.2_of_it_found_with_the_right_sensor" + tail, more["named"] / more["sessions"], 0.99)
        yield info(prefix + "1.2_of_it_found" + tail, more["found"] / more["sessions"])
        yield info(prefix + "1.2_of_it_no_other_as_likely" + tail, more["for_sure"] / more["sessions"])
        yield info(prefix + "smallest_change_mean" + tail, least["smallest_mm"], "mm")
        yield info(prefix + "smallest_turn_mean" + tail, least["smallest_deg"], "deg")


def history_rows(prefix, tally):
    for times, bumps in sorted(tally["bumps"].items()):
        if bumps["sessions"]:
            yield info(prefix + "bumps_of_%s_told_by_their_session" % times, "%d_of_%d" % (bumps["named"], bumps["sessions"]))
    yield info(prefix + "bumps_missed_that_a_later_session_told", "%d_of_%d" % (tally["missed_and_told_later"], tally["missed"]))
    swaps = tally["swaps"]
    yield equal(prefix + "swaps_told_as_moved_on_purpose", swaps["told"], swaps["sessions"])
    yield at_most(prefix + "swaps_that_accuse_a_sensor", swaps["accused"], most_by_chance(swaps["sessions"], ALPHA))
    for rate, drifts in sorted(tally["drifts"].items(), key=lambda item: float(item[0])):
        name = prefix + "drift_of_%smm_in_30_days_" % rate
        yield info(name + "told", "%d_of_%d" % (len(drifts["weeks"]), drifts["robots"]), detail=["another sensor accused first: %d" % drifts["wrong"]])
        for key, what in (("weeks", "told_after"), ("weeks_until_rate", "rate_beyond_4_sigmas_after")):
            if drifts[key]:
                weeks = statistics.median(drifts[key])
                yield info(name + what + "_median", float(weeks), "weeks")
                yield info(name + what + "_median_change", float(rate) * weeks * 7 / 30, "mm")


def drawn_rows(context, prefix, *more):
    robots, weeks, beside = FULL if context.full else QUICK
    result = context.run_json("fleet_measure", robots, weeks, SEED, beside, *more, timeout=20000)
    yield info(prefix + "robots", result["robots"])
    yield info(prefix + "weeks", result["weeks"])
    yield info(prefix + "drawn_in", result["took_s"], "s")
    tally = result["tally"]
    yield from quiet_rows(prefix, tally["quiet"])
    yield from told_moved_rows(prefix, tally)
    yield from event_rows(prefix, tally["events"])
    yield from history_rows(prefix, tally)


def alone_rows(context):
    """Robots that no other tells what visits scatter by: few visits do not tell along which axes."""
    for what in ("alone", "alone-one-axis"):
        robots, weeks, beside = ALONE
        tally = context.run_json("fleet_measure", robots, weeks, SEED, beside, what, timeout=3000)["tally"]
        prefix = what.replace("-", "_") + "_"
        yield from quiet_rows(prefix, tally["quiet"])
        for first, last, name in GROUPS:
            least = summed(tally["events"]["1.0"], first, last)
            if least:
                yield info(prefix + "smallest_change_mean_visits_" + name, least["smallest_mm"], "mm")


# Of the recordings' rig: where each frame hangs, up to the frame that all share.
RIG = {"cam%d" % k: ("box_base->alphasense_base", "alphasense_base->cam%d_sensor_frame" % k) for k in range(1, 6)}
RIG.update({"hdr_" + side: ("box_base->hdr_base", "hdr_base->hdr_" + side) for side in ("front", "left", "right")})
RIG.update({"zed_" + side: ("box_base->zed2i_base", "zed2i_base->zed2i_" + side) for side in ("left", "right")})
RIG.update({"hesai": ("box_base->hesai_lidar",), "livox": ("box_base->livox_lidar",)})
CAMERA_DATES = ("2024-10-31T18:44:00", "2024-11-03T08:37:00", "2024-11-03T20:28:00", "2024-11-05T15:50:00", "2024-11-05T18:19:00",
                "2024-11-05T21:02:00", "2024-11-10T20:28:00", "2024-11-10T20:28:01", "2024-11-30T14:59:00")
REPEAT = 7  # the cameras' calibration of the visit before, once more
# What the recordings' description states of repeatability, its ends.
STATED = ((1.0, 0.1), (5.0, 0.4))


def dated_poses(context):
    """Per visit, sensor -> (p, q) in the frame that all share."""
    edges = json.loads((context.data / "drift_grandtour" / "tf_static_series.json").read_text())["edges"]
    visits = []
    for visit in range(len(CAMERA_DATES)):
        poses = {}
        for sensor, chain in RIG.items():
            pose = ([0.0] * 3, [0.0, 0.0, 0.0, 1.0])
            for edge in chain:
                pose = composed(pose, (edges[edge][visit]["t"], edges[edge][visit]["q_xyzw"]))
            poses[sensor] = pose
        visits.append(poses)
    return visits


def as_text(visits):
    lines = []
    for date, poses in zip(CAMERA_DATES, visits):
        lines.append("visit " + date)
        lines += ["%s %s" % (sensor, " ".join("%.17g" % x for x in list(p) + list(q))) for sensor, (p, q) in poses.items()]
    return "\n".join(lines) + "\n"


def apart(a, b):
    """mm and deg."""
    p, q = composed(inverse(a), b)
    return 1e3 * math.sqrt(sum(x * x for x in p)), 2 * math.degrees(math.atan2(math.sqrt(sum(x * x for x in q[:3])), abs(q[3])))


def largest_change(visits, sigma_mm, sigma_deg):
    """Visit, sensor, mm and deg of the largest step from one visit to the next, seen from the first camera, in what is stated."""
    def size(step):
        return max(step[2] / sigma_mm, step[3] / sigma_deg)
    steps = []
    for visit in range(1, len(visits)):
        for sensor in visits[0]:
            before, after = (composed(inverse(visits[k]["cam1"]), visits[k][sensor]) for k in (visit - 1, visit))
            steps.append((visit, sensor, *apart(before, after)))
    return max(steps, key=size)


def dated_rows(context):
    if not (context.data / "drift_grandtour" / "tf_static_series.json").exists():
        yield skip("dated", "no dated calibrations beside the repository")
        return
    visits = dated_poses(context)
    for sigma_mm, sigma_deg in STATED:
        name = "dated_at_%gmm_%gdeg_" % (sigma_mm, sigma_deg)
        done = subprocess.run([str(context.bin / "fleet_history"), str(sigma_mm), str(sigma_deg)], input=as_text(visits), capture_output=True,
                              text=True, timeout=60, check=True)
        told = json.loads(done.stdout)["visits"]
        visit, sensor, mm, deg = largest_change(visits, sigma_mm, sigma_deg)
        lines = ["visit %d (%s): %d in use, accused %s, worst %.1f sigmas, smallest change %.1f mm %.2f deg" %
                 (k + 1, one["visit"], one["visits_in_use"], one["accused"], one["worst_sigmas"], one["smallest_mm"], one["smallest_deg"])
                 for k, one in enumerate(told)]
        lines.append("largest: %s at visit %d, %.1f mm %.2f deg" % (sensor, visit, mm, deg))
        yield equal(name + "largest_change_flagged", int(sensor in told[visit - 1]["accused"]), 1, lines)
        yield equal(name + "repeat_flagged", len(told[REPEAT - 1]["accused"]), 0)
        yield info(name + "visits_that_accuse", "%d_of_%d" % (sum(1 for one in told if one["accused"]), len(told)))


def run(context):
    yield from drawn_rows(context, "")
    if context.full:
        yield from drawn_rows(context, "reference_scatters_", "reference-scatters")
    yield from alone_rows(context)
    yield from dated_rows(context)
