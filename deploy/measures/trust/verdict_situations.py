"""Twenty-one kinds of situations, each twice with other numbers: what is done to a robot and its session, and what is true of it. The states,
first sentences and actions were written down from what is true, before the service was asked. In short: fail, where the robot is not as it
is taken to be; unknown, where the session does not tell; fail or unknown, where a mistaken session gives numbers that contradict each
other; warn, where poses are known and something is to be mended."""
import dataclasses
import math
import re
import typing

from . import verdict_breaks as broken
from .verdict_rigs import BODY, FRONT
from .verdict_wanted import Wanted

RAD = math.pi / 180
CORNERS = ("left", "right", "top", "back")  # sensors of finished edges
AGAIN = r"capture|record|repeat|again|new session"


@dataclasses.dataclass
class Situation:
    robot: str  # and name of the situation
    push: typing.Callable  # (bench, robot) -> the last command, done
    wanted: Wanted


def all_of(*words):
    return "".join("(?=.*%s)" % word for word in words)


def name(word):
    return r"(?<!\w)%s(?!\w)" % word


def drawn(sensors, *options, spoil=lambda session: None, **visit):
    """Pushes a visit that was spoilt."""
    def push(bench, robot):
        session = bench.visit(robot, sensors, *options, **visit)
        spoil(session)
        return bench.push(session)
    return push


def clean(robot, sensors, captures):
    return Situation(robot, drawn(sensors, captures=captures), Wanted("pass", r"agree|check|verified|within", r"nothing|until|none|next"))


def bumped(robot, sensors, sensor, by, ratio, captures=20):
    first = int(ratio * captures) + 1  # capture after the bump; two aside are right enough
    near = "|".join(str(capture) for capture in range(first - 2, first + 3))
    return Situation(robot, drawn(sensors, "--bump", sensor, "--bump-by", by, "--bump-at", ratio, captures=captures),
                     Wanted("fail", r"^(sensor |camera )?%s (was|has been) (moved|bumped).*captures? \D*0*(%s)\b" % (sensor, near),
                            all_of(r"(mount|fasten|tighten|fix|screw|secure)", "--remounted " + sensor), (sensor,)))


def two_visits(old, new):
    """Between them a sensor went elsewhere."""
    def push(bench, robot):
        bench.push(bench.visit(robot, FRONT, days=30, name="first"))
        return bench.push(bench.visit(robot, FRONT, days=2, name="second", changes=((old, new),)))
    return push


def apart(robot, states, sensor, old, new, by_mm, action):
    """By so little that a loose mount may do it."""
    return Situation(robot, two_visits(old, new),
                     Wanted(states, r"^(sensor |camera )?%s (sat|was|has been) .*\b(%s)(\.\d+)? mm" % (sensor, by_mm), action, (sensor,)))


def moved_between(robot, sensor, old, new):
    return Situation(robot, two_visits(old, new), Wanted("fail", r"^(sensor |camera )?%s (was|has been) moved between .*\d mm" % sensor,
                                         "rigcal push .*--remounted " + sensor, (sensor,)))


def board_moved(robot, by, ratio):
    return Situation(robot, drawn(BODY, "--board-moved", "%s@%g" % (by, ratio)),
                     Wanted("warn|pass", r"^(the )?(board )?front (was|has been) moved", r"fix|fasten|still|stand|" + AGAIN, ("front",)))


def other_instant(robot, sensors, sensor, capture):
    return Situation(robot, drawn(sensors, "--wrong-instant", "%02d:%s" % (capture, sensor)),
                     Wanted("warn|pass", all_of(name(sensor), r"\b0*%d\b" % capture), r"trigger|synchron|instant|same (moment|time)|" + AGAIN,
                            (sensor,)))


def fisheye(robot, sensor, changes):
    def spoil(session):
        header = session / "session.yaml"
        text, count = re.subn(r"intrinsics: \{model: fisheye_kb4.*\}", "model: pinhole_radtan", header.read_text())
        if count != 1:
            raise RuntimeError("one fisheye")
        header.write_text(text)
    return Situation(robot, drawn(FRONT, "--tilt-deg", 12, changes=changes, spoil=spoil),
                     Wanted("fail|unknown", all_of(name(sensor), "lens|fisheye"), "model: fisheye_kb4", (sensor,)))


def declared(robot, sensors, said, states, why, action, captures=20):
    """Another board than was there."""
    return Situation(robot, drawn(sensors, captures=captures, spoil=lambda session: broken.declare(session, said)),
                     Wanted(states, all_of(name("front"), why), action, ("front",)))


def squares(robot, sensors, square_m, captures):
    return declared(robot, sensors, ("square_size_m: 0.09,", "square_size_m: %g," % square_m), "fail|unknown", "square", "square_size_m", captures)


def counts(robot, corners):
    return declared(robot, FRONT, ("inner_corners: [10, 7]", "inner_corners: [%d, %d]" % corners), "unknown",
                    r"(corner|squares|counts|10 (x|by) 7)", "inner_corners")


def files(robot, spoil, states, why, action):
    return Situation(robot, drawn(FRONT, spoil=spoil), Wanted(states, all_of("front_top", why), action, ("front_top",)))


def millimetres(robot, sensors, captures):
    return Situation(robot, drawn(sensors, captures=captures, spoil=lambda session: broken.in_millimetres(session, "body")),
                     Wanted("fail|unknown", all_of(name("body"), r"(millimet|in mm\b|unit)"), r"metres|poses\.csv", ("body",)))


def exchanged(robot, sensors, a, b, states, captures):
    return Situation(robot, drawn(sensors, captures=captures, spoil=lambda session: broken.exchange(session, a, b)),
                     Wanted(states, all_of(a, b, "(exchang|swap|each other)"), "exchang|swap|folder|cable|rename", (a, b)))


def level(robot, sensors, motion, open_):
    return Situation(robot, drawn(sensors, "--motion", motion, "--tilt-deg", 0), Wanted("unknown", all_of(name("body"), open_),
                                                                                       r"ramp|tilt|slope|wedge|(two|second|another) ax", ("body",)))


def overdue(robot, days):
    return Situation(robot, drawn(FRONT, days=days), Wanted("unknown", r"overdue|days? old|out of date", r"calibrat|" + AGAIN, in_text=True,
                                                            drive="Not verified: do not rely on"))


def foreign(robot, owner, spoil):
    """The pictures of one robot, as another's."""
    def push(bench, robot):
        session = bench.visit(owner, FRONT)
        bench.push(session)
        bench.named[robot] = bench.named[owner]
        broken.declare(session, ("robot: " + owner, "robot: " + robot))
        spoil(session)
        return bench.push(session)
    return Situation(robot, push, Wanted("unknown|refused", all_of(owner, "(same|already|picture|files)"), r"robot:|session\.yaml|robot's name"))


def edges(robot, made, states, why, action, never):
    return Situation(robot, lambda bench, robot: bench.push_edges(robot, made), Wanted(states, why, action, CORNERS, never=never))


def sure(robot, count, off_mm, off_deg, sigmas):
    """Stated sigmas are too small; nothing that matters to a robot."""
    return edges(robot, broken.ring(CORNERS[:count], 1e-3 * off_mm, off_deg * RAD, sigmas), "pass|warn", r"agree|within|check|tolerance", ".",
                 r"moved|bumped|exchanged|two poses|contradict")


def unsure(robot, count, off_mm, sigmas):
    """No contradiction, and no pose that can be relied on."""
    return edges(robot, broken.ring(CORNERS[:count], 1e-3 * off_mm, 0.0, sigmas, sigma_rad=0.02 * RAD), "warn|unknown",
                 all_of(r"\b(%s)\b" % "|".join(CORNERS), r"\d mm"), r"measure|calibrate|" + AGAIN, r"moved|bumped|exchanged|contradict")


def unchecked(robot, made):
    nothing = r"unchecked|\b(no|not|nothing|nobody|without|hardly|weak|only|single)\b.*(check|loop|second|other way|confirm)"
    return edges(robot, made, "warn", nothing, r"pair|measure|push|add|" + AGAIN, r"moved|bumped|exchanged|contradict")
