"""One robot, week after week: what a visit and a question cost must not depend on how many visits came before. Once with finished edges, once with
capture sessions of a small rig."""
import datetime
import json
import math
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import time

from ..measure import Measure, at_most, info
from ..rotations import composed, inverse, of_vector
from ..server import ANSWERED, Server

SENSORS, PAIRS, BLOCKS = 12, 59, 40
SIGMA = (2e-4,) * 3 + (1e-4,) * 3  # of an edge, m and rad
CAMERAS = ("front_left", "front_right", "left_front", "left_back")  # of the sessions' rig, beside the tracker's body
EARLY_WEEK, WINDOW_WEEK = 2, 10  # the first that has one before it; the first in which visits have been merged
PUSH_MAX_S = 120.0  # beyond it the weeks that are left would take days


class Rig:
    """Twelve sensors with fixed poses and 59 pairs of them: a ring, then whatever else there is."""

    def __init__(self):
        draw = random.Random(1)
        self.poses = [([draw.uniform(-1, 1) for _ in range(3)], of_vector([draw.uniform(-1, 1) for _ in range(3)])) for _ in range(SENSORS)]
        every = [(a, b) for a in range(SENSORS) for b in range(a + 1, SENSORS)]
        ring = [(a, a + 1) for a in range(SENSORS - 1)]
        self.pairs = ring + draw.sample([pair for pair in every if pair not in ring], PAIRS - len(ring))

    def edge(self, pair, draw):
        """The truth with an error of SIGMA; blocks that scatter as a jackknife of such an error does."""
        error = [draw.gauss(0, s) for s in SIGMA]
        p, q = composed(composed(inverse(self.poses[pair[0]]), self.poses[pair[1]]), (error[:3], of_vector(error[3:])))
        blocks = [{"block_id": "%02d" % k, "d": [draw.gauss(0, s / math.sqrt(BLOCKS - 1)) for s in SIGMA]} for k in range(BLOCKS)]
        covariance = [[SIGMA[i] ** 2 if i == k else 0.0 for k in range(6)] for i in range(6)]
        return {"frame_a": "s%02d" % pair[0], "frame_b": "s%02d" % pair[1], "T_a_b": {"p_m": p, "q_xyzw": q}, "covariance": covariance,
                "method": "growth", "source": "jackknife", "dof": BLOCKS - 1, "blocks": blocks}

    def week(self, number):
        draw = random.Random(1000 + number)
        return {"format": 1, "edges": [self.edge(pair, draw) for pair in self.pairs]}


def read_pose(text):
    """Of "{p_m: [x, y, z], q_xyzw: [x, y, z, w]}"."""
    numbers = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text.replace("p_m", "").replace("q_xyzw", ""))]
    return numbers[:3], numbers[3:7]


class EdgeVisits:
    """Every week the edges of all pairs, as another tool found them."""
    prefix, robot, ends = "", "growing", ("s00", "s11")
    reports_max = 21  # those of one month: 20 and the one in use

    def __init__(self, context, folder):
        self.folder, self.rig = folder, Rig()

    def prepare(self, week):
        (self.folder / "week.json").write_text(json.dumps(self.rig.week(week)))

    def push(self, server):
        return server.rigcal("push-edges", self.folder / "week.json", "--robot", self.robot, "--json")

    def truth(self):
        return composed(inverse(self.rig.poses[0]), self.rig.poses[11])


class SessionVisits:
    """Every week a session of four small cameras and a tracker's body."""
    prefix, robot, ends = "sessions_", "mars-mapper", ("front_left", "left_back")
    reports_max = 21
    simulated = ()

    def __init__(self, context, folder):
        self.rigcal, self.folder, self.session = str(context.bin / "rigcal"), folder, folder / "session"
        whole = self.run("simulate", "--print-rig", "mars-mapper")
        begin, end = whole.index("sensors:\n") + len("sensors:\n"), whole.index("# The upright lidar")
        sensors = [one for one in re.split(r"(?m)^(?=  \w+:)", whole[begin:end]) if one.strip().split(":")[0] in CAMERAS + ("body",)]
        (folder / "rig.yaml").write_text(whole[:begin] + "".join(sensors))

    def run(self, *arguments):
        done = subprocess.run([self.rigcal, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError("rigcal %s: %s" % (arguments[0], done.stderr.strip()[-200:]))
        return done.stdout

    def prepare(self, week):
        shutil.rmtree(self.session, ignore_errors=True)
        at = datetime.datetime(2016, 1, 4) + datetime.timedelta(weeks=week)
        self.run("simulate", self.folder / "rig.yaml", "--out", self.session, "--captures", 12, "--scale", 0.25, "--seed", week,
                 "--captured-at", at.strftime("%Y-%m-%dT%H:%M:%SZ"), *self.simulated)

    def push(self, server):
        return server.rigcal("push", self.session, "--json")

    def truth(self):
        told = (self.session / "truth.yaml").read_text()
        return read_pose(re.search(r"  left_back:\n    type: camera\n    T_ref_sensor: (\{.*\})", told).group(1))


class ScatteredVisits(SessionVisits):
    """The same where every sensor sits a little elsewhere on each visit: the truth that is compared with is that visit's."""
    prefix, simulated = "scattered_sessions_", ("--visit-scatter", "0.3,0.01")


def timed(ask):
    began = time.monotonic()
    done = ask()
    return time.monotonic() - began, done


def folder_bytes(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def newest_report(data):
    """The folder of the report that was published last."""
    folders = [path for path in (data / "reports").rglob("revisions/*") if path.is_dir()] or [path.parent for path in (data / "reports").rglob("index.html")]
    return max(folders, key=lambda path: path.stat().st_mtime)


def bytes_of_its_own(data, report):
    """What the report's visit added to the disk: files that no other report has."""
    others = {path.stat().st_ino for path in (data / "reports").rglob("*") if path.is_file() and report not in path.parents}
    return sum(path.stat().st_size for path in report.rglob("*") if path.is_file() and path.stat().st_ino not in others)


def wait_published(server, robot, number):
    """Asks until the revision has a report; a question takes its time, so that nothing else need be waited for."""
    asked_until = time.monotonic() + PUSH_MAX_S
    while time.monotonic() < asked_until:
        shown = json.loads(server.rigcal("show", robot, "--json").stdout)
        if shown["published"] and shown["revision"] >= number:
            return
    raise RuntimeError("revision %d was not published" % number)


def is_right(answer, truth, week):
    """Of the newest revision, the pose within 4 of its sigmas of the truth."""
    p, q = truth
    apart_m = [a - b for a, b in zip(answer["T_a_b"]["p_m"], p)]
    length_m, sigma_m = math.sqrt(sum(x * x for x in apart_m)), math.sqrt(sum(answer["covariance"][i][i] for i in range(3)))
    return answer["revision"] == week and 0 < sigma_m < 1e-2 and length_m < 4 * sigma_m


def visit(server, visits, week):
    """Figures of one weekly visit."""
    visits.prepare(week)
    push_s, pushed = timed(lambda: visits.push(server))
    if pushed.returncode not in ANSWERED:
        raise RuntimeError("week %d: push: exit %d: %s" % (week, pushed.returncode, pushed.stderr.strip()[-200:]))
    figures = {"push_to_revision_s": push_s}
    figures["cold_lookup_s"], looked = timed(lambda: server.rigcal("lookup", visits.robot, *visits.ends, "--json"))
    figures["lookup_answered"] = looked.returncode in ANSWERED and is_right(json.loads(looked.stdout), visits.truth(), week)
    return figures


def settled(server, data, visits, week, figures):
    """What is only taken of the weeks that are compared."""
    wait_published(server, visits.robot, week)
    figures["warm_lookup_s"] = statistics.median(timed(lambda: server.rigcal("lookup", visits.robot, *visits.ends))[0] for _ in range(5))
    figures["show_s"] = statistics.median(timed(lambda: server.rigcal("show", visits.robot))[0] for _ in range(5))
    figures["document_bytes"] = len(server.rigcal("show", visits.robot, "--json").stdout)
    figures["report_bytes"] = folder_bytes(newest_report(data))
    figures["report_bytes_of_its_own"] = bytes_of_its_own(data, newest_report(data))
    figures["reports_kept"] = len([path for path in (data / "reports" / visits.robot).iterdir() if path.name.isdigit()])
    figures["peak_rss_mib"] = server.peak_rss_mib()
    return figures


def push_weeks(context, kind, weeks):
    """Figures of every week pushed; of those that are compared more of them."""
    all_of_them = []
    with context.folder() as name:
        folder = pathlib.Path(name)
        visits = kind(context, folder)
        with Server(context, folder / "data") as server:
            for week in range(1, weeks + 1):
                all_of_them.append(visit(server, visits, week))
                last = week == weeks or all_of_them[-1]["push_to_revision_s"] > PUSH_MAX_S
                if last or week in (EARLY_WEEK, WINDOW_WEEK):
                    settled(server, folder / "data", visits, week, all_of_them[-1])
                if last:
                    return all_of_them


def rows(kind, weeks, figures):
    week, late, answered = len(figures), figures[-1], sum(one["lookup_answered"] for one in figures)
    yield Measure(kind.prefix + "weeks_pushed", str(week), "==%d" % weeks, "ok" if week == weeks else "SHORT")
    yield Measure(kind.prefix + "cold_lookups_answered", "%d_of_%d" % (answered, week), "all", "ok" if answered == week else "SHORT")
    for key in ("push_to_revision_s", "cold_lookup_s", "warm_lookup_s", "show_s", "document_bytes", "report_bytes", "report_bytes_of_its_own", "peak_rss_mib"):
        for early in (EARLY_WEEK, WINDOW_WEEK):
            if early < week:
                yield at_most(kind.prefix + "%s_week_%d_over_week_%d" % (key, week, early), late[key] / figures[early - 1][key], 1.2)
        yield info(kind.prefix + "%s_week_%d" % (key, week), float(late[key]))
    for key in ("push_to_revision_s", "cold_lookup_s"):
        first, last = (statistics.median(one[key] for one in part) for part in (figures[1:6], figures[-5:]))
        yield at_most(kind.prefix + "%s_median_of_5_to_week_%d_over_weeks_2_to_6" % (key, week), last / first, 1.2)
    yield at_most(kind.prefix + "reports_kept_week_%d" % week, late["reports_kept"], kind.reports_max)
    yield at_most(kind.prefix + "show_week_%d" % week, 1e3 * late["show_s"], 50.0, "ms")
    yield at_most(kind.prefix + "cold_lookup_week_%d" % week, 1e3 * late["cold_lookup_s"], 30.0, "ms")
    yield at_most(kind.prefix + "warm_lookup_week_%d" % week, 1e3 * late["warm_lookup_s"], 30.0, "ms")


def run(context):
    weeks = 520 if context.full else 26
    for kind in (EdgeVisits, SessionVisits, ScatteredVisits):
        yield from rows(kind, weeks, push_weeks(context, kind, weeks))
