"""Sessions that break what a calibration takes for granted: whether the service is ever sure and wrong. Hostile truth comes from
client/sim, of which server/ uses nothing; each row is worked out from what the verdict, the diagnoses and the sigmas say."""
import math

from ..measure import Measure, at_least, at_most, equal, info, skip, within
from . import trust_boards, trust_islands, trust_lidars, trust_real, trust_weak_pair
from .counted_sessions import CountedSessions

LIDARS = ("lidar_vertical", "lidar_horizontal")
CAPTURES_OFF = 2  # a named capture may be this far from the first after a bump


class Counts:
    """Sessions per scenario, from seed 1 on; with --full those that the limits are meant for; with --counted those of them that were judged before."""
    QUICK = {"clean": 4, "coverage": 1, "pair_visits": 2, "bump": 2, "late_bump": 2, "misfit": 1, "rig_shift": 1, "pair_shift": 4, "bursts": 1,
             "pose_clock": 2, "refocus": 2}
    FULL = {"clean": 1000, "coverage": 200, "pair_visits": 100, "visits": 20, "bump": 36, "late_bump": 12, "misfit": 100, "rig_shift": 30, "pair_shift": 100,
            "bursts": 200, "pose_clock": 20, "pupil_shift": 20, "second_tracker": 12, "other": 20, "refocus": 20}

    def __init__(self, context):
        self.of = self.FULL if context.full else self.QUICK


class NotCounted(Exception):
    pass


def sessions(context, scenario, count):
    judged = CountedSessions(context, "trust_measure").judged(scenario, count, only_counted=context.counted)
    if not judged:
        raise NotCounted(scenario)
    return judged


def beside(context, scenarios, count):
    """The same numbers of each scenario, as far as all of them are counted."""
    every = [sessions(context, scenario, count) for scenario in scenarios]
    least = min(len(judged) for judged in every)
    return [judged[:least] for judged in every]


def if_counted(rows):
    try:
        yield from rows
    except NotCounted as error:
        yield skip(str(error), "not counted yet")


def percent(flags):
    flags = list(flags)
    return 100.0 * sum(flags) / len(flags)


def is_covered(pose, which=0):
    return pose["known"] and (pose["limit"] is None or pose["t2"][which] <= pose["limit"])  # None: so few degrees of freedom that nothing lies outside


def covered_by_sensor(judged):
    """{sensor: % of its poses inside their own 95 % region}; a pose that is not known is not covered."""
    names = sorted({name for one in judged for name in one["sensors"]})
    return {name: percent(is_covered(one["sensors"][name], k) for one in judged if name in one["sensors"]
                          for k in range(len(one["sensors"][name].get("t2", [0])))) for name in names}


def covered_of_all(judged):
    return percent(is_covered(pose, k) for one in judged for pose in one["sensors"].values() for k in range(len(pose.get("t2", [0]))))


def squares(poses, key, part):
    return sum(value * value for pose in poses for value in pose[key][part])


def bump(context, counts, name, found_min):
    judged = sessions(context, name, counts.of["bump"])
    title = name + "_of_%d" % len(judged)
    yield at_least(title + "_found", percent(one["verdict"] == "fail" for one in judged), found_min, "%")
    yield at_least(title + "_sensor_right", percent(one["moved_sensors"] == [one["bumped"]] for one in judged), 95.0, "%")
    yield at_least(title + "_capture_within_2", percent(names_capture(one) for one in judged), 90.0, "%")
    yield info(title + "_pass", percent(one["verdict"] == "pass" for one in judged), "%")
    yield at_least(title + "_inside_region_after_it", percent(pose["known"] and pose["t2_after"] <= pose["limit"]
                                                              for one in judged for pose in one["sensors"].values()), 90.0, "%")


def late_bump(context, counts, name):
    """So near the end that it may be as well another instant: in doubt, whose sensor is named."""
    judged = sessions(context, name, counts.of["late_bump"])
    title = "%s_of_%d" % (name, len(judged))
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_sensor_named", percent(one["bumped"] in one["moved_sensors"] for one in judged), 95.0, "%")


def pair_bump(context, counts, name, both={"front_left", "front_right"}):
    """Of a robot's only two sensors nobody can tell which one was moved."""
    judged = sessions(context, name, counts.of["late_bump"])
    title = "%s_of_%d" % (name, len(judged))
    yield at_least(title + "_found", percent(one["verdict"] == "fail" for one in judged), 100.0, "%")
    yield equal(title + "_both_named", percent(set(one["moved_sensors"]) == both for one in judged), 100.0)


def board_without_tracker(context, counts):
    """The world is what the boards say: which of them moved is told by the others."""
    judged = sessions(context, "no_tracker_board_moved", counts.of["late_bump"])
    title = "no_tracker_board_moved_of_%d" % len(judged)
    yield at_most(title + "_sensor_accused_alone", percent(one["moved_said"] and not one["moved_board_named"] for one in judged), 5.0, "%")
    yield equal(title + "_pass_with_a_pose_outside", passes_outside(judged), 0.0)


def bumps(context, counts):
    for name, found_min in (("bump_20_mm", 100.0), ("bump_5_mm", 100.0), ("bump_2_mm", 95.0)):
        yield from if_counted(bump(context, counts, name, found_min))
    for name in ("bump_before_last_1", "bump_before_last_2", "bump_before_last_burst_of_4"):
        yield from if_counted(late_bump(context, counts, name))
    for name in ("pair_bump_5_mm", "pair_bump_12_mm", "pair_bump_20_mm", "pair_bump_100_mm"):
        yield from if_counted(pair_bump(context, counts, name))
    for name, other in (("camera_tracker_bump_12_mm", "body"), ("camera_lidar_bump_12_mm", "lidar_vertical")):
        yield from if_counted(pair_bump(context, counts, name, {"front_left", other}))
    yield from if_counted(board_without_tracker(context, counts))


def names_capture(judged):
    """The first capture after the bump, by its name's number."""
    return any(abs(int(capture) - 1 - judged["bumped_from_idx"]) <= CAPTURES_OFF for capture in judged["moved_captures"])


def clean(context, counts):
    judged = sessions(context, "clean", counts.of["clean"])
    yield at_most("clean_accused_of_%d" % len(judged), percent(one["verdict"] == "fail" or one["moved_said"] for one in judged), 0.5, "%")
    yield info("clean_pass", percent(one["verdict"] == "pass" for one in judged), "%")
    yield from efficiency(judged[:100])


def efficiency(judged):
    """Rms error over the Cramer-Rao bound of the whole rig."""
    for kind in ("cameras", "lidars"):
        poses = [pose for one in judged for name, pose in one["sensors"].items()
                 if name != "body" and (name in LIDARS) == (kind == "lidars") and pose["known"]]
        for unit, part in (("translation", slice(0, 3)), ("rotation", slice(3, 6))):
            ratio = math.sqrt(squares(poses, "e", part) / squares(poses, "bound", part))
            yield at_most("%s_rms_over_cramer_rao_%s_of_%d" % (kind, unit, len(judged)), ratio, 1.08)


def covered_or_named(judged, title):
    """What is asked of sessions whose lenses are not as their model has them."""
    covered = min(covered_by_sensor(judged).values())
    named = percent(one["verdict"] != "pass" and bool(one["lens_sensors"]) for one in judged)
    yield Measure(title + "_worst_covered_or_lens_named", "%.3g%%_or_%.3g%%" % (covered, named), ">=90%_or_>=95%",
                  "ok" if covered >= 90 or named >= 95 else "SHORT")
    yield info(title + "_covered", covered_of_all(judged), "%")
    yield at_most(title + "_moved_said", percent(one["moved_said"] for one in judged), 1.0, "%")


def misfit(context, counts, px, intrinsics):
    judged = sessions(context, "misfit_%s_px_%s" % (px, intrinsics), counts.of["misfit"])
    yield from covered_or_named(judged, "lens_misfit_%s_px_%s_of_%d" % (px, intrinsics, len(judged)))


def pupil_shift(context, counts, name):
    judged = sessions(context, name, counts.of["pupil_shift"])
    yield from covered_or_named(judged, "%s_of_%d" % (name, len(judged)))


def pupil_shifts(context, counts):
    """Rays of a lens that do not meet in one point: what is near is seen elsewhere than what is far, whatever the model."""
    if not context.full:
        yield skip("pupil_shifts", "only with --full")
        return
    for name in ("pupil_shift_0.5_mm", "pupil_shift_2_mm", "pair_pupil_shift_0.5_mm", "pair_pupil_shift_2_mm", "pupil_tangent_2_mm"):
        yield from if_counted(pupil_shift(context, counts, name))


def misfits(context, counts):
    """A lens that its model cannot describe: covered all the same, or not passed and the lens named."""
    every = [(px, intrinsics) for px in ("0.05", "0.1") for intrinsics in ("given", "estimated")]
    for px, intrinsics in every if context.full else (every[0], every[3]):
        yield from if_counted(misfit(context, counts, px, intrinsics))


def shifted_poses(judged, clean_ones):
    """(with, without) the shift: of the shifted camera; of all others where it is the reference."""
    for one, without in zip(judged, clean_ones):
        for name, pose in one["sensors"].items():
            is_its_own = name == one["picture_sensor"] or one["picture_sensor"] not in one["sensors"]
            if is_its_own and pose["known"] and without["sensors"][name]["known"]:
                yield pose, without["sensors"][name]


def ratio_of(pairs, key, part):
    """Rms with over rms without; of nothing (a pose became unknown) it is without limit."""
    if not pairs:
        return math.inf
    return math.sqrt(squares([one for one, _ in pairs], key, part) / squares([without for _, without in pairs], key, part))


def shift(context, counts, robot, px):
    judged, clean_ones = beside(context, ["%s_shift_%d_px" % (robot, px), robot + "_shift_0_px"], counts.of[robot + "_shift"])
    title = "%s_capture_off_%d_px_of_%d" % (robot, px, len(judged))
    pairs = list(shifted_poses(judged, clean_ones))
    yield at_most(title + "_error_over_clean", max(ratio_of(pairs, "e", part) for part in (slice(0, 3), slice(3, 6))), 1.1)
    yield equal(title + "_named", percent(one["picture_named"] for one in judged), 100.0)
    yield info(title + "_sigma_over_clean", ratio_of(pairs, "sigma", slice(0, 3)))


def shifts(context, counts):
    for robot in ("rig", "pair"):
        for px in (3, 8, 20) if context.full or robot == "pair" else (8,):
            yield from if_counted(shift(context, counts, robot, px))


def visit(context, counts, name):
    judged = sessions(context, name, counts.of[name])
    yield within("next_of_10_%s_inside_region_of_%d_robots" % (name, len(judged)), covered_of_all(judged), 95, 3, "%")


def visits(context, counts):
    """Ten visits of one robot, whose sensors sit a little elsewhere on each; where they sit on the next twenty."""
    for name in ("pair_visits", "visits"):
        if name not in counts.of:
            yield skip("next_of_10_visits", "12 sensors only with --full")
            continue
        yield from if_counted(visit(context, counts, name))


def coverage(context, counts):
    judged = sessions(context, "coverage", counts.of["coverage"])
    for name, covered in covered_by_sensor(judged).items():
        yield within("covered_" + name, covered, 95, 2, "%") if context.full else info("covered_" + name, covered, "%")
    # Of few sessions the part that is covered says little.
    yield at_least("covered_of_all_%d" % len(judged), covered_of_all(judged), 93 if context.full else 80, "%")
    yield equal("coverage_failed_edges", sum(one["failed_edges"] for one in judged), 0)


def bursts(context, counts):
    judged = sessions(context, "bursts", counts.of["bursts"])
    for name, covered in covered_by_sensor(judged).items():
        yield within("bursts_covered_" + name, covered, 95, 2, "%") if context.full else info("bursts_covered_" + name, covered, "%")
    yield at_least("bursts_covered_of_all_%d" % len(judged), covered_of_all(judged), 93 if context.full else 80, "%")
    yield at_most("bursts_lens_named", percent(bool(one["lens_sensors"]) for one in judged), 1.0, "%")
    if not context.full:
        yield skip("thousand_captures", "only with --full")
        return
    yield from if_counted(thousand_captures(context))


def thousand_captures(context):
    [thousand] = sessions(context, "thousand", 1)
    yield at_most("thousand_captures_judged", thousand["judge_s"], 30.0, "s")
    yield at_least("thousand_captures_covered", covered_of_all([thousand]), 80, "%")


def refocus(context, counts):
    """A lens whose focal length changes by 0.3 % half-way: not moved along its line of sight, or nobody can tell which."""
    judged = sessions(context, "refocus", counts.of["refocus"])
    title = "refocus_of_%d" % len(judged)
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_lens_named", percent(one["refocused"] in one["lens_sensors"] for one in judged), 95.0, "%")
    yield at_most(title + "_moved_said_without_a_word_of_the_lens", percent(one["moved_said"] and not one["lens_sensors"] for one in judged), 1.0, "%")
    yield info(title + "_covered", covered_of_all(judged), "%")


def clock_error_sigmas(judged):
    """How many told sigmas the told offset is from the true one; of a clock of which nothing is told it is without limit."""
    if len(judged["clocks"]) != 1:
        return math.inf
    [clock] = judged["clocks"]
    return abs(clock["late_s"] - judged["clock_late_s"]) / clock["sigma_s"]


def pose_clock(context, counts):
    """A tracker whose clock is off, on a robot that does not stop for its captures; beside the same visits with a clock that is right."""
    right, off = beside(context, ["pose_clock_right", "pose_clock_offset"], counts.of["pose_clock"])
    count = len(off)
    title = "pose_clock_offset_of_%d" % count
    pairs = [(name == "body", (pose, without["sensors"][name])) for one, without in zip(off, right) for name, pose in one["sensors"].items()
             if pose["known"] and without["sensors"][name]["known"]]
    for of_body, who in ((True, "body"), (False, "others")):
        of_these = [pair for is_body, pair in pairs if is_body == of_body]
        yield at_most("%s_error_over_clean_%s" % (title, who), max(ratio_of(of_these, "e", part) for part in (slice(0, 3), slice(3, 6))), 1.1)
    yield at_most(title + "_off_by_sigmas", max(clock_error_sigmas(one) for one in off), 3.0)
    yield info(title + "_error_rms", 1e3 * math.sqrt(sum((clock["late_s"] - one["clock_late_s"]) ** 2 for one in off for clock in one["clocks"]) / count), "ms")
    yield info(title + "_pass", percent(one["verdict"] == "pass" for one in off), "%")


def passes_outside(judged):
    """Sure and wrong: "pass", with a pose outside its region."""
    return percent(one["verdict"] == "pass" and not all(is_covered(pose) for pose in one["sensors"].values()) for one in judged)


def displaced(context, counts, name, named_min):
    """A sensor that is elsewhere for a while, or more and more: it is told, and nobody else is accused."""
    judged = sessions(context, name, counts.of["late_bump"])
    title = "%s_of_%d" % (name, len(judged))
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_sensor_named", percent(one["displaced"] in one["moved_sensors"] for one in judged), named_min, "%")
    yield at_most(title + "_others_accused", percent(bool(set(one["moved_sensors"]) - {one["displaced"]}) for one in judged), 5.0, "%")


def two_bumps(context, counts):
    judged = sessions(context, "two_bumps", counts.of["late_bump"])
    title = "two_bumps_of_%d" % len(judged)
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_both_named", percent({one["bumped"], one["displaced"]} <= set(one["moved_sensors"]) for one in judged), 95.0, "%")
    yield at_most(title + "_others_accused", percent(bool(set(one["moved_sensors"]) - {one["bumped"], one["displaced"]}) for one in judged), 5.0, "%")


def scattering(context, counts, name):
    """Nothing moved for good: mounts rattle, or the tracker drifts."""
    judged = sessions(context, name, counts.of["late_bump"])
    title = "%s_of_%d" % (name, len(judged))
    yield at_least(title + "_covered", covered_of_all(judged), 90.0, "%")
    yield equal(title + "_pass_with_a_pose_outside", passes_outside(judged), 0.0)
    yield at_most(title + "_others_accused", percent(bool(set(one["moved_sensors"]) - {"body", "mast"}) for one in judged), 5.0, "%")


def exchanged_lenses(context, counts, name):
    """Two cameras with each other's intrinsics."""
    judged = sessions(context, name, counts.of["late_bump"])
    title = "%s_of_%d" % (name, len(judged))
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_both_lenses_named", percent({"front_left", "front_right"} <= set(one["lens_sensors"]) for one in judged), 95.0, "%")
    yield at_most(title + "_moved_said", percent(one["moved_said"] for one in judged), 5.0, "%")


def loose_mounts(context, counts):
    if not context.full:
        yield skip("loose_mounts", "only with --full")
        return
    for name in ("excursion_20_mm", "excursion_5_mm", "creep_5_mm"):
        yield from if_counted(displaced(context, counts, name, 95.0))
    yield from if_counted(two_bumps(context, counts))
    for name in ("rattle", "rattle_0.1_mm", "tracker_drift"):
        yield from if_counted(scattering(context, counts, name))
    for name in ("exchanged_lenses", "pair_exchanged_lenses"):
        yield from if_counted(exchanged_lenses(context, counts, name))


def second_tracker_with_moved_world(context, counts):
    """The origin of its poses jumps half-way: its body sits where it sat."""
    judged = sessions(context, "second_tracker_world_moved_5_mm", counts.of["second_tracker"])
    title = "second_tracker_world_moved_5_mm_of_%d" % len(judged)
    yield equal(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 0.0)
    yield at_least(title + "_tracker_named", percent("mast" in one["why"] for one in judged), 95.0, "%")
    yield at_most(title + "_sensor_said_to_have_moved", percent(bool(one["moved_sensors"]) for one in judged), 5.0, "%")
    yield at_least(title + "_covered", covered_of_all(judged), 90.0, "%")


def second_trackers(context, counts):
    """Another tracker that tells its body in a world of its own, as odometry beside motion capture."""
    if not context.full:
        yield skip("second_trackers", "only with --full")
        return
    judged = sessions(context, "second_tracker", counts.of["second_tracker"])
    title = "second_tracker_of_%d" % len(judged)
    yield at_least(title + "_pass", percent(one["verdict"] == "pass" for one in judged), 95.0, "%")
    yield at_least(title + "_covered", covered_of_all(judged), 90.0, "%")
    yield from covered_or_named(sessions(context, "second_tracker_misfit_0.1_px_given", counts.of["second_tracker"]), "second_tracker_misfit_0.1_px_given")
    yield from if_counted(displaced_second_tracker(context, counts))
    yield from if_counted(second_tracker_with_moved_world(context, counts))
    yield from if_counted(scattering(context, counts, "second_tracker_drift"))


def displaced_second_tracker(context, counts):
    judged = sessions(context, "second_tracker_bump_5_mm", counts.of["second_tracker"])
    title = "second_tracker_bump_5_mm_of_%d" % len(judged)
    yield at_least(title + "_found", percent(one["verdict"] == "fail" for one in judged), 100.0, "%")
    yield at_least(title + "_sensor_right", percent(one["moved_sensors"] == ["mast"] for one in judged), 95.0, "%")
    yield at_least(title + "_capture_within_2", percent(names_capture(one) for one in judged), 90.0, "%")


def other(context, counts, name):
    judged = sessions(context, name, counts.of["other"])
    yield info("%s_of_%d_pass_with_a_pose_outside" % (name, len(judged)), passes_outside(judged), "%")
    yield info("%s_of_%d_covered" % (name, len(judged)), covered_of_all(judged), "%")


def others(context, counts):
    """What else may go wrong; of these it matters that nobody is sure and wrong."""
    if not context.full:
        yield skip("board_moved_and_others", "only with --full")
        return
    for name in ("board_moved", "wrong_instant", "bent_boards", "stretched_boards_0.1_percent", "stretched_boards_0.3_percent", "no_tracker_stretched_boards_0.1_percent", "no_tracker_stretched_boards_0.3_percent", "pair_stretched_boards_0.1_percent", "pair_stretched_boards_0.3_percent", "wrong_aspect_0.1_percent", "pair_wrong_aspect_0.1_percent", "incidence_bias", "mixed_pixels", "single_tags", "pair_single_tags"):
        yield from if_counted(other(context, counts, name))


def run(context):
    counts = Counts(context)
    for part in (bumps, clean, misfits, pupil_shifts, shifts, visits, coverage, bursts, pose_clock, refocus, second_trackers, loose_mounts, others):
        yield from if_counted(part(context, counts))
    if not context.counted:
        yield from trust_real.run(context)
        yield from trust_lidars.run(context)
        yield from trust_weak_pair.run(context)
        yield from trust_boards.run(context)
        yield from trust_islands.run(context)
