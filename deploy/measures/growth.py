"""One robot, week after week: what a visit and a question cost must not depend on how many visits came before."""
import json
import math
import pathlib
import random
import statistics
import time

from .measure import Measure, at_most, info
from .server import ANSWERED, Server

SENSORS, PAIRS, BLOCKS = 12, 59, 40
SIGMA = (2e-4,) * 3 + (1e-4,) * 3  # of an edge, m and rad
EARLY_WEEK = 2
PUSH_MAX_S = 120.0  # beyond it the weeks that are left would take days


def quaternion(v):
    """Of a rotation vector, x y z w."""
    angle = math.sqrt(sum(x * x for x in v))
    ratio = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    return [ratio * x for x in v] + [math.cos(angle / 2)]


def times(a, b):
    """Of two quaternions x y z w."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def turned(q, v):
    x, y, z, _ = times(times(q, list(v) + [0.0]), [-q[0], -q[1], -q[2], q[3]])
    return [x, y, z]


def composed(a, b):
    (p_a, q_a), (p_b, q_b) = a, b
    return [p_a[i] + t for i, t in enumerate(turned(q_a, p_b))], times(q_a, q_b)


def inverse(pose):
    p, q = pose
    back = [-q[0], -q[1], -q[2], q[3]]
    return [-x for x in turned(back, p)], back


class Rig:
    """Twelve sensors with fixed poses and 59 pairs of them: a ring, then whatever else there is."""

    def __init__(self):
        draw = random.Random(1)
        self.poses = [([draw.uniform(-1, 1) for _ in range(3)], quaternion([draw.uniform(-1, 1) for _ in range(3)])) for _ in range(SENSORS)]
        every = [(a, b) for a in range(SENSORS) for b in range(a + 1, SENSORS)]
        ring = [(a, a + 1) for a in range(SENSORS - 1)]
        self.pairs = ring + draw.sample([pair for pair in every if pair not in ring], PAIRS - len(ring))

    def edge(self, pair, draw):
        """The truth with an error of SIGMA; blocks that scatter as a jackknife of such an error does."""
        error = [draw.gauss(0, s) for s in SIGMA]
        p, q = composed(composed(inverse(self.poses[pair[0]]), self.poses[pair[1]]), (error[:3], quaternion(error[3:])))
        blocks = [{"block_id": "%02d" % k, "d": [draw.gauss(0, s / math.sqrt(BLOCKS - 1)) for s in SIGMA]} for k in range(BLOCKS)]
        covariance = [[SIGMA[i] ** 2 if i == k else 0.0 for k in range(6)] for i in range(6)]
        return {"frame_a": "s%02d" % pair[0], "frame_b": "s%02d" % pair[1], "T_a_b": {"p_m": p, "q_xyzw": q}, "covariance": covariance,
                "method": "growth", "source": "jackknife", "dof": BLOCKS - 1, "blocks": blocks}

    def week(self, number):
        draw = random.Random(1000 + number)
        return {"format": 1, "edges": [self.edge(pair, draw) for pair in self.pairs]}


def timed(server, *arguments):
    began = time.monotonic()
    done = server.rigcal(*arguments, timeout=600)
    return time.monotonic() - began, done


def folder_bytes(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def newest_report(data):
    """The folder of the report that was published last."""
    folders = [path for path in (data / "reports").rglob("revisions/*") if path.is_dir()] or [path.parent for path in (data / "reports").rglob("index.html")]
    return max(folders, key=lambda path: path.stat().st_mtime)


def wait_published(server, number):
    """Asks until the revision has a report; a question takes its time, so that nothing else need be waited for."""
    asked_until = time.monotonic() + PUSH_MAX_S
    while time.monotonic() < asked_until:
        shown = json.loads(server.rigcal("show", "growing", "--json").stdout)
        if shown["published"] and shown["revision"] >= number:
            return
    raise RuntimeError("revision %d was not published" % number)


def is_right(answer, rig, week):
    """Of the newest revision, the pose within 4 of its sigmas of the truth."""
    p, q = composed(inverse(rig.poses[0]), rig.poses[11])
    apart_m = [a - b for a, b in zip(answer["T_a_b"]["p_m"], p)]
    length_m, sigma_m = math.sqrt(sum(x * x for x in apart_m)), math.sqrt(sum(answer["covariance"][i][i] for i in range(3)))
    return answer["revision"] == week and 0 < sigma_m < 1e-2 and length_m < 4 * sigma_m


def visit(server, rig, folder, week):
    """Figures of one weekly visit."""
    path = folder / "week.json"
    path.write_text(json.dumps(rig.week(week)))
    push_s, pushed = timed(server, "push-edges", path, "--robot", "growing", "--json")
    if pushed.returncode not in ANSWERED:
        raise RuntimeError("week %d: push-edges: exit %d: %s" % (week, pushed.returncode, pushed.stderr.strip()[-200:]))
    figures = {"push_to_revision_s": push_s}
    figures["cold_lookup_s"], looked = timed(server, "lookup", "growing", "s00", "s11", "--json")
    figures["lookup_answered"] = looked.returncode in ANSWERED and is_right(json.loads(looked.stdout), rig, week)
    return figures


def settled(server, data, week, figures):
    """What is only taken of the weeks that are compared."""
    wait_published(server, week)
    figures["warm_lookup_s"] = statistics.median(timed(server, "lookup", "growing", "s00", "s11")[0] for _ in range(5))
    figures["show_s"] = statistics.median(timed(server, "show", "growing")[0] for _ in range(5))
    figures["document_bytes"] = len(server.rigcal("show", "growing", "--json").stdout)
    figures["report_bytes"] = folder_bytes(newest_report(data))
    figures["reports_kept"] = len([path for path in (data / "reports" / "growing").iterdir() if path.name.isdigit()])
    figures["peak_rss_mib"] = server.peak_rss_mib()
    return figures


def run(context):
    weeks = 520 if context.full else 26
    early, late, answered, rig, visits = {}, {}, 0, Rig(), []
    with context.folder() as name:
        folder = pathlib.Path(name)
        with Server(context, folder / "data") as server:
            for week in range(1, weeks + 1):
                late = visit(server, rig, folder, week)
                answered += late["lookup_answered"]
                visits.append(late)
                if week == EARLY_WEEK:
                    early = settled(server, folder / "data", week, late)
                if late["push_to_revision_s"] > PUSH_MAX_S:
                    break
            late = settled(server, folder / "data", week, late)
    yield Measure("weeks_pushed", str(week), "==%d" % weeks, "ok" if week == weeks else "SHORT")
    yield Measure("cold_lookups_answered", "%d_of_%d" % (answered, week), "all", "ok" if answered == week else "SHORT")
    for key, limit in (("push_to_revision_s", 1.2), ("cold_lookup_s", 1.2), ("warm_lookup_s", 1.2), ("show_s", 1.2), ("document_bytes", 1.2),
                       ("report_bytes", 1.2), ("peak_rss_mib", 1.2)):
        yield at_most("%s_week_%d_over_week_%d" % (key, week, EARLY_WEEK), late[key] / early[key], limit)
        yield info("%s_week_%d" % (key, week), float(late[key]))
    for key in ("push_to_revision_s", "cold_lookup_s"):
        first, last = (statistics.median(one[key] for one in part) for part in (visits[1:6], visits[-5:]))
        yield at_most("%s_median_of_5_to_week_%d_over_weeks_2_to_6" % (key, week), last / first, 1.2)
    yield at_most("reports_kept_week_%d" % week, late["reports_kept"], 21)  # those of one month: 20 and the one in use
    yield at_most("show_week_%d" % week, 1e3 * late["show_s"], 50.0, "ms")
    yield at_most("cold_lookup_week_%d" % week, 1e3 * late["cold_lookup_s"], 30.0, "ms")
    yield at_most("warm_lookup_week_%d" % week, 1e3 * late["warm_lookup_s"], 30.0, "ms")
