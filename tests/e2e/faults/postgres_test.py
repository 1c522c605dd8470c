"""Rows in PostgreSQL: the same pushes give the same ids and digests as on SQLite, also after kill -9 and after the database was away."""
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from edge_case import edge  # noqa: E402
from flow import ROOT, Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOTS = ("rig", "mapper")


def push(flow):
    """Edges, the same once more, and a session: the same files each time."""
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    for held_before in (0, 3):
        pushed = json.loads(flow.rigcal("push-edges", path, "--robot", "rig", "--json").stdout)
        check(pushed["held_before"] == held_before, "held before: %r" % pushed)
    flow.rigcal("simulate", front_rig(flow, "mapper", "rig"), "--out", flow.folder / "session", "--seed", 1, "--captures", 12, "--scale", 0.3,
                "--captured-at", "2026-01-31T10:00:00Z")
    flow.rigcal("push", flow.folder / "session")


def told(flow):
    """What must not depend on the engine."""
    wait_published(flow)
    answers = {"sessions": [one["session"] for one in json.loads(flow.rigcal("sessions", "--json").stdout)["sessions"]]}
    for robot in ROBOTS:
        shown = json.loads(flow.rigcal("show", robot, "--json").stdout)
        answers[robot] = {"revision": shown["revision"], "digest": shown["digest"],
                          "edges": [one["id"] for one in json.loads(flow.rigcal("edges", robot, "--json").stdout)["edges"]]}
    return answers


def on_sqlite():
    with Flow() as flow:
        push(flow)
        return told(flow)


def database_url(name):
    return os.environ["RIGCAL_TEST_POSTGRES"] + name + os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]


def in_database(sql):
    subprocess.run(["psql", "--quiet", "--no-psqlrc", database_url("postgres"), "--command", sql], check=True, stdout=subprocess.DEVNULL)


def on_postgres():
    in_database("CREATE DATABASE service")
    os.environ["RIGCAL_STORE"] = database_url("service")
    with Flow() as flow:
        check(not (flow.folder / "store" / "rigcal.db").exists(), "no row is in the data folder")
        push(flow)
        answers = told(flow)
        flow.kill_and_restart()
        check(told(flow) == answers, "the same after kill -9: %r" % told(flow))
        in_database("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = 'service'")
        check(told(flow) == answers, "the same after the database was away")
        refused = flow.rigcal("backup", flow.folder / "backup", "--data", flow.folder / "store", exit_code=4)
        check("pg_dump" in refused.stdout + refused.stderr, "a backup says what to use: " + refused.stderr)
    del os.environ["RIGCAL_STORE"]
    return answers


def main():
    if "RIGCAL_TEST_POSTGRES" not in os.environ:
        os.execv(ROOT / "tests/postgres/with_postgres", ["with_postgres", sys.executable, __file__])
    check(on_postgres() == on_sqlite(), "the same ids and digests on both engines")


main()
