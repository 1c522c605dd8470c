"""A store of SQLite is copied to PostgreSQL, killed on the way, and back: a server on either tells the same, and goes on."""
import contextlib
import json
import os
import random
import signal
import subprocess
import sys

sys.path.insert(0, os.path.dirname(__file__))
from both_engines import database_url, in_database, push, push_edges, told, with_postgres  # noqa: E402
from flow import Flow, Server, check  # noqa: E402
from report_again_test import await_page  # noqa: E402

REFUSED, KILLS = 4, 12


def migrate(flow, *arguments, exit_code=0):
    return flow.rigcal("migrate-store", *arguments, exit_code=exit_code)


def killed_on_the_way(flow, arguments, chance, mark):
    """At some time after the copy has begun: whether it was under way."""
    process = subprocess.Popen(flow.server.client("migrate-store", *arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env=flow.server.environment())
    while not mark.exists() and process.poll() is None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=0.005)
    try:
        process.wait(timeout=chance.uniform(0.0, 0.2))
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


def refusals(flow, source, target, moved):
    for arguments, wanted in (
            ((source, target, "--data", moved), "a rigcald uses the store"),
            ((source, target), "Give with --data the folder"),
            ((target, target, "--data", moved), "both stores are in PostgreSQL"),
            ((source, "mysql://db/rigcal"), "neither a folder nor a PostgreSQL database"),
            (("sqlite:%s" % (flow.folder / "nowhere"), target, "--data", moved), "holds no store"),
            ((target, "sqlite:%s" % (flow.folder / "back"), "--data", moved), "there is no store at postgresql://")):
        refused = migrate(flow, *arguments, exit_code=REFUSED)
        check(wanted in refused.stderr and refused.stderr.count("\n") == 1, "%r is refused with one sentence: %s" % (arguments, refused.stderr))
    check(not moved.exists() or list(moved.iterdir()) == [], "a refusal leaves nothing")


def serve(flow, data, store=None):
    """The flow goes on with that store."""
    flow.server.stop()
    os.environ.pop("RIGCAL_STORE", None)
    if store is not None:
        os.environ["RIGCAL_STORE"] = store
    flow.server = Server(flow.context, data, flow.server.tag)
    flow.server.start()
    flow.address = flow.ready()


def to_postgres(flow, source, target, moved):
    arguments = (source, target, "--data", moved)
    chance, under_way = random.Random(24), 0
    for _ in range(KILLS):
        under_way += killed_on_the_way(flow, arguments, chance, moved / "unfinished-copy")
    check(under_way > 3, "%d of %d were killed on the way" % (under_way, KILLS))
    if (moved / "unfinished-copy").exists():
        told_of = json.loads(migrate(flow, *arguments, "--json").stdout)
        check(told_of["lost"] == [] and (told_of["was_complete"] or told_of["rows"] > 100), "it is copied: %r" % told_of)
    check("is not empty" in migrate(flow, *arguments, exit_code=REFUSED).stderr, "what is there is not overwritten")


def main():
    with_postgres(__file__)
    in_database("CREATE DATABASE moved")
    with Flow() as flow:
        source, target, moved = "sqlite:%s" % (flow.folder / "store"), database_url("moved"), flow.folder / "moved"
        push(flow)
        answers = told(flow)
        flow.rigcal("approve", "mapper", answers["mapper"]["revision"], "--reason", "checked", "--by", "Ada", exit_code=0)
        refusals(flow, source, target, moved)
        flow.server.stop()
        to_postgres(flow, source, target, moved)
        flow.rigcal("fsck", flow.folder / "store", exit_code=0)
        serve(flow, moved, target)
        check(told(flow) == answers, "the same on PostgreSQL: %r" % told(flow))
        await_page(flow, "/robots/mapper/revisions/%d/" % answers["mapper"]["revision"])  # drawn again, of files that are links
        flow.rigcal("audit", "verify", exit_code=0)
        push_edges(flow, 3)
        flow.rigcal("reject", "rig", answers["rig"]["revision"], "--reason", "a loose mount", "--by", "Ada", exit_code=0)
        flow.server.stop()
        migrate(flow, target, "sqlite:%s" % (flow.folder / "back"), "--data", moved)
        flow.rigcal("fsck", flow.folder / "back", exit_code=0)
        serve(flow, flow.folder / "back")
        check(told(flow) == answers, "the same on SQLite again")
        flow.rigcal("audit", "verify", exit_code=0)


main()
