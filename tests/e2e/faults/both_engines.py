"""What is pushed to a store, and what of it must not depend on which engine keeps the rows."""
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import ROOT, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOTS = ("rig", "mapper")


def with_postgres(program):
    """The program again, with a PostgreSQL of its own, where it has none yet."""
    if "RIGCAL_TEST_POSTGRES" not in os.environ:
        os.execv(ROOT / "tests/postgres/with_postgres", ["with_postgres", sys.executable, program])


def database_url(name):
    return os.environ["RIGCAL_TEST_POSTGRES"] + name + os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]


def in_database(sql):
    subprocess.run(["psql", "--quiet", "--no-psqlrc", database_url("postgres"), "--command", sql], check=True, stdout=subprocess.DEVNULL)


def push_edges(flow, held_before):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    pushed = json.loads(flow.rigcal("push-edges", path, "--robot", "rig", "--json").stdout)
    check(pushed["held_before"] == held_before, "held before: %r" % pushed)


def push(flow):
    """Edges, the same once more, and a session: the same files each time."""
    push_edges(flow, 0)
    push_edges(flow, 3)
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
