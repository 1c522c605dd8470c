"""The situations, each kind twice."""
from . import verdict_breaks as broken
from .verdict_rigs import BODY, FRONT
from .verdict_situations import (AGAIN, CORNERS, Situation, all_of, apart, board_moved, bumped, clean, counts, drawn, exchanged, files, fisheye, foreign,
                                 level, millimetres, moved_between, name, other_instant, overdue, squares, sure, unchecked, unsure)
from .verdict_wanted import Wanted

PAIR = ("front_left", "front_right")
LEFT = ("left_front", "left_back")
LIDARS = ("lidar_vertical", "lidar_horizontal")
FRONT_RIGHT, FRONT_TOP = "p_m: [0.301, -0.101, -0.001], rpy_deg: [-0.4, 0.2, -0.6]}", "p_m: [0.302, 0.004, 0.151], rpy_deg: [0.2, 1.3, -0.4]}"
# Turned aside, so that the board is seen from 20 to 70 degrees off the axis, where no pinhole model follows a fisheye.
FISHEYE_RIGHT = ((FRONT_RIGHT, FRONT_RIGHT.replace("-0.6", "-45.6")),
                 ("lens: {fx_px: 1448.9, fy_px: 1448.4, cx_px: 1218.2, cy_px: 1027.9, distortion: [-0.0795, 0.0702, -0.00018, 0.00041, -0.0098]},\n"
                  "     intrinsics_sigma: [0.1, 0.1, 0.1, 0.1, 0.0002, 0.0003, 0.00001, 0.00001, 0]}\n  front_top",
                  "lens: {model: fisheye_kb4, fx_px: 900, fy_px: 900.4, cx_px: 1218.2, cy_px: 1027.9, distortion: [-0.02, 0.002, 0, 0]}}\n"
                  "  front_top"))
FISHEYE_TOP = ((FRONT_TOP, FRONT_TOP.replace("-0.4]", "48.2]")),
               ("lens: {fx_px: 1449.1, fy_px: 1449.7, cx_px: 1221.3, cy_px: 1021.2, distortion: [-0.081, 0.072, 0.0001, 0.0002, -0.01]},\n"
                "     intrinsics_sigma: [0.1, 0.1, 0.1, 0.1, 0.0002, 0.0003, 0.00001, 0.00001, 0]}",
                "lens: {model: fisheye_kb4, fx_px: 1000, fy_px: 1000.3, cx_px: 1221.3, cy_px: 1021.2, distortion: [-0.05, 0.03, -0.02, 0.004]}}"))
UPRIGHT = (("yaw_range_deg: 16", "yaw_range_deg: 0"), ("tilt_rms_deg: 5", "tilt_rms_deg: 0"), ("rpy_deg: [3, 12, -10]", "rpy_deg: [0, 0, 0]"))
MISSING = ("left_front", "left_back", "back")


def slip(robot, known):
    def push(bench, robot):
        bench.push_edges(known, broken.chain(CORNERS[:3], 1e-4, 1e-5))
        return bench.push(bench.visit(robot, PAIR, captures=2))
    return Situation(robot, push, Wanted("refused", all_of(robot, known, "(new|mean|known)"), "--new-robot"))


def misspelt_verb(robot, verb):
    return Situation(robot, lambda bench, robot: bench.server.rigcal(verb, "visit/"),
                     Wanted("refused", "no verb '%s'.*did you mean push" % verb, "rigcal push|mean push|--help", refused_code=2))


SITUATIONS = [
    clean("clean-three-cameras", FRONT, 20),
    clean("clean-with-tracker", BODY, 24),
    bumped("bumped-5-mm", FRONT, "front_right", "0.005,0.5", 0.5),
    bumped("bumped-12-mm-early", BODY, "front_top", "0.012,1", 0.3),
    moved_between("moved-8-mm-aside", "front_right", "[0.301, -0.101,", "[0.301, -0.109,"),
    moved_between("moved-15-mm-up", "front_top", "[0.302, 0.004, 0.151]", "[0.302, 0.004, 0.166]"),
    apart("apart-6-mm-aside", "warn|fail", "front_right", "[0.301, -0.101,", "[0.301, -0.107,", "5|6", "--remounted front_right"),
    apart("apart-4-mm-up", "pass|warn", "front_top", "[0.302, 0.004, 0.151]", "[0.302, 0.004, 0.155]", "3|4", "."),
    board_moved("board-moved-30-mm", "0.03,2", 0.5),
    board_moved("board-moved-80-mm-early", "0.08,5", 0.3),
    other_instant("other-instant-07", FRONT, "front_left", 7),
    other_instant("other-instant-15-tracker", BODY, "front_top", 15),
    fisheye("fisheye-front-right", "front_right", FISHEYE_RIGHT),
    fisheye("fisheye-front-top", "front_top", FISHEYE_TOP),
    squares("squares-100-mm-lidar", PAIR + LIDARS[:1], 0.1, 20),
    squares("squares-85-mm-tracker", BODY, 0.085, 20),
    counts("corners-11-by-8", (11, 8)),
    counts("corners-9-by-6", (9, 6)),
    files("pictures-cut-short", lambda session: broken.cut_short(session, "front_top", 300), "unknown",
          r"(cannot be (read|opened)|could not be (read|opened)|unreadable|damaged|broken|cut)", "copy|" + AGAIN),
    files("half-of-the-files-missing", lambda session: broken.drop_files(session, "front_top", 0.5), "warn", r"(10 of (the )?20|missing|half)",
          "copy|check|" + AGAIN),
    millimetres("tracker-in-mm", BODY, 20),
    millimetres("tracker-in-mm-left", LEFT + ("body",), 20),
    exchanged("cameras-exchanged", FRONT, "front_left", "front_right", "fail", 20),
    exchanged("lidars-exchanged", LEFT + LIDARS, *LIDARS, "fail|unknown", 20),
    Situation("three-captures", drawn(FRONT, captures=3),
              Wanted("unknown", r"(3|three|few) (different )?captures|captures .*(few|short)|too few|short session", r"\bcaptures\b", FRONT)),
    Situation("boards-upright", drawn(FRONT, "--intrinsics", "absent", changes=UPRIGHT),
              Wanted("unknown", all_of("(board|%s)" % name("front"), "(tilt|frontal|straight)"), "tilt", FRONT + ("front",))),
    level("level-floor", BODY, "planar", "height"),
    level("turned-on-the-spot", PAIR + ("body",), "spot", "(height|position|turn|axis|spot)"),
    overdue("measured-120-days-ago", 120),
    overdue("measured-six-years-ago", 2190),
    slip("maper-01", "mapper-01"),
    misspelt_verb("misspelt-verb", "pusch"),
    foreign("sorter-07", "hauler-03", lambda session: None),
    foreign("picker-south", "mower-east", lambda session: broken.renamed_captures(session, "visit")),
    sure("off-0.119-mm-at-4-sigma", 3, 0.119, 0.008, 4),
    sure("off-0.3-mm-at-6-sigma", 4, 0.3, 0.02, 6),
    unsure("off-25-mm-at-1-sigma", 3, 25, 1),
    unsure("off-40-mm-at-1.2-sigma", 4, 40, 1.2),
    Situation("caps-on-the-lenses", drawn(FRONT, spoil=lambda session: broken.darken(session, FRONT)),
              Wanted("unknown", all_of("(picture|board|camera)", r"(no board|not (be )?(seen|found)|sees? no|dark|black|none|no picture)"),
                     r"light|\bcaps?\b|lens|look at|open (the|one)|rigcal check", FRONT + ("front",))),
    Situation("three-sensors-absent", drawn(FRONT + MISSING, spoil=lambda session: broken.drop_sensors(session, *MISSING)),
              Wanted("unknown", all_of(*[name(sensor) for sensor in MISSING],
                                       r"(no (files|pictures|data)|missing|not measured|never measured|absent|nothing)"),
                     "copy|check|" + AGAIN, MISSING)),
    unchecked("no-loop", broken.chain(CORNERS[:3], 1e-4, 1e-5)),
    unchecked("weak-loop", broken.weak_ring(CORNERS[:4], 1e-4, 0.1)),
]
