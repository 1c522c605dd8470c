"""Rows in PostgreSQL: the same pushes give the same ids and digests as on SQLite, also after kill -9 and after the database was away."""
import os
import sys

sys.path.insert(0, os.path.dirname(__file__))
from both_engines import database_url, in_database, push, told, with_postgres  # noqa: E402
from flow import Flow, check  # noqa: E402


def on_sqlite():
    with Flow() as flow:
        push(flow)
        return told(flow)


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
    with_postgres(__file__)
    check(on_postgres() == on_sqlite(), "the same ids and digests on both engines")


main()
