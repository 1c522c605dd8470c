"""A store that a program of before filled for half a year (schema 4, of when every question went through all of a robot's history): is it migrated with
progress, with the same poses, and fast afterwards? With --full alone: that program is built from this repository's history, once."""
import contextlib
import json
import pathlib
import re
import shutil
import sqlite3
import statistics
import subprocess
import types

from ..measure import Measure, at_most, equal, info, skip
from ..rotations import composed, inverse
from ..server import ANSWERED, Server
from .growth import EdgeVisits, SessionVisits, is_right, timed, wait_published

COMMIT = "d8538e9a"  # the last one of schema 4
PROGRAMS = ("rigcald", "rigcal", "rigcal-simulate")
WEEKS, SESSIONS = 31, 3


def git(context, *arguments):
    return subprocess.run(["git", "-C", str(context.root), *map(str, arguments)], capture_output=True, text=True)


def built_before(context):
    """The folder of that program; None: this clone has no history."""
    if git(context, "cat-file", "-e", COMMIT + "^{commit}").returncode != 0:
        return None
    tree = context.root / "build" / "measure" / ("schema-4-" + COMMIT)
    binaries = tree / "build" / "release" / "bin"
    if not all((binaries / name).exists() for name in PROGRAMS):
        shutil.rmtree(tree, ignore_errors=True)
        tree.mkdir(parents=True)
        archive = subprocess.Popen(["git", "-C", str(context.root), "archive", COMMIT], stdout=subprocess.PIPE)
        subprocess.run(["tar", "-x", "-C", str(tree)], stdin=archive.stdout, check=True)
        if archive.wait() != 0:
            raise RuntimeError("git archive %s: exit %d" % (COMMIT, archive.returncode))
        for command in (["cmake", "--preset", "release"], ["ninja", "-C", "build/release"] + ["bin/" + name for name in PROGRAMS]):
            subprocess.run(command, cwd=tree, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return binaries


def answered(done):
    if done.returncode not in ANSWERED:
        raise RuntimeError("exit %d: %s" % (done.returncode, done.stderr.strip()[-200:]))
    return json.loads(done.stdout)


def poses_of(document):
    """Of sensors that are known."""
    return {one["id"]: one["T_ref_sensor"] for one in document["sensors"] if one["T_ref_sensor"]}


def told_before(data, visits):
    """Number and poses of the newest revision, as they lie in the store: from week 30 on its own program answers nobody in time."""
    with contextlib.closing(sqlite3.connect("file:%s?mode=ro" % (data / "rigcal.db"), uri=True)) as database:
        number, document = database.execute("SELECT number, document FROM revision WHERE robot_id = ? ORDER BY number DESC", (visits.robot,)).fetchone()
    return {"revision": number, "sensors": poses_of(json.loads(document))}


def told_now(server, visits):
    revision = answered(server.rigcal("show", visits.robot, "--json"))
    looked = answered(server.rigcal("lookup", visits.robot, *visits.ends, "--json"))
    return {"revision": revision["revision"], "sensors": poses_of(revision.get("document", revision)), "T_a_b": looked["T_a_b"]}


def fill(before, folder, data):
    """What its program tells of each robot, and the visits to go on with."""
    visits = [kind(types.SimpleNamespace(bin=before), folder / name) for kind, name in ((EdgeVisits, "edges"), (SessionVisits, "sessions"))]
    with Server(types.SimpleNamespace(bin=before), data) as server:
        for one, weeks, push in ((visits[0], WEEKS, "push-edges"), (visits[1], SESSIONS, "push")):
            for week in range(1, weeks + 1):
                one.prepare(week)
                what = [one.folder / "week.json", "--robot", one.robot] if push == "push-edges" else [one.session]
                done = server.rigcal(push, *what, timeout=900)
                if done.returncode not in ANSWERED:
                    raise RuntimeError("%s of week %d by the program of before: exit %d: %s" % (push, week, done.returncode, done.stderr.strip()[-200:]))
    return visits, [told_before(data, one) for one in visits]


def apart(x, y):
    """Largest difference of any number of two poses."""
    return max(abs(a - b) for key in ("p_m", "q_xyzw") for a, b in zip(x[key], y[key]))


def between(poses, a, b):
    """The pose of b in a, of the reference too, which is listed as where it is."""
    as_pair = [(poses[one]["p_m"], poses[one]["q_xyzw"]) for one in (a, b)]
    p_m, q_xyzw = composed(inverse(as_pair[0]), as_pair[1])
    return {"p_m": p_m, "q_xyzw": q_xyzw}


def same_rows(name, visits, before, now):
    yield equal(name + "_revision", now["revision"], before["revision"])
    yield equal(name + "_sensors", len(now["sensors"]), len(before["sensors"]))
    yield at_most(name + "_poses_apart", max(apart(pose, now["sensors"][sensor]) for sensor, pose in before["sensors"].items() if sensor in now["sensors"]), 0.0)
    yield at_most(name + "_lookup_apart", apart(between(before["sensors"], *visits.ends), now["T_a_b"]), 1e-9)


def speed_rows(name, server, visits, week):
    visits.prepare(week)
    push_s, pushed = timed(lambda: visits.push(server))
    if pushed.returncode not in ANSWERED:
        raise RuntimeError("week %d: push: exit %d: %s" % (week, pushed.returncode, pushed.stderr.strip()[-200:]))
    yield info(name + "_first_push_to_revision", push_s, "s")
    visits.prepare(week + 1)
    push_s, _ = timed(lambda: visits.push(server))
    yield info(name + "_next_push_to_revision", push_s, "s")
    looked = answered(server.rigcal("lookup", visits.robot, *visits.ends, "--json"))
    yield equal(name + "_next_lookup_is_within_4_sigmas", is_right(looked, visits.truth(), week + 1), True)
    wait_published(server, visits.robot, answered(server.rigcal("show", visits.robot, "--json"))["revision"])
    for verb, words, limit_ms in (("lookup", visits.ends, 30.0), ("show", (), 50.0)):
        seconds = statistics.median(timed(lambda: server.rigcal(verb, visits.robot, *words))[0] for _ in range(5))
        yield at_most(name + "_" + verb, 1e3 * seconds, limit_ms, "ms")


def run(context):
    if not context.full:
        yield skip("store_of_schema_4", "only with --full")
        return
    before = built_before(context)
    if before is None:
        yield skip("store_of_schema_4", "this clone has no history to build its program from")
        return
    with context.folder() as name:
        folder = pathlib.Path(name)
        for part in ("edges", "sessions"):
            (folder / part).mkdir()
        data = folder / "data"
        visits, stories = fill(before, folder, data)
        yield info("bytes_before", sum(path.stat().st_size for path in data.rglob("*") if path.is_file()) / 2 ** 20, "MiB")
        server = Server(context, data)
        start_s, _ = timed(lambda: server.start().wait_ready())
        with contextlib.closing(types.SimpleNamespace(close=server.stop)):
            yield info("migrated_and_ready", start_s, "s")
            log = pathlib.Path(str(data) + ".log").read_text()
            steps = re.findall(r"the store (?:is brought|is being brought|was brought) forward", log)
            yield Measure("progress_lines", str(len(steps)), ">=2", "ok" if len(steps) >= 2 else "SHORT", log.splitlines()[-12:])
            for one, story in zip(visits, stories):
                yield from same_rows(one.prefix + "poses", one, story, told_now(server, one))
            yield from speed_rows("edges", server, visits[0], WEEKS + 1)
            yield from speed_rows("sessions", server, visits[1], SESSIONS + 1)
            yield info("peak_rss", server.peak_rss_mib(), "MiB")
