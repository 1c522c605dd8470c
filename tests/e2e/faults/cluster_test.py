"""deploy/cluster: a server, a worker and the primary are killed amid the work, parts are added and drained; nothing that had a receipt is lost, and
every id and digest is that of a quiet server on SQLite."""
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, os.path.dirname(__file__))
from both_engines import push, push_edges, told  # noqa: E402
from flow import ROOT, SKIPPED, Flow, check  # noqa: E402

REFUSED = 1


class Cluster:
    def __init__(self, flow):
        self.flow, self.folder = flow, flow.folder / "cluster"

    def __call__(self, *words, exit_code=0):
        done = subprocess.run([str(ROOT / "deploy/cluster"), *words, "--folder", str(self.folder)], capture_output=True, text=True,
                              env=self.flow.server.environment(), timeout=180)
        check(done.returncode == exit_code, "%r: exit %d: %s%s%s" % (words, done.returncode, done.stdout, done.stderr, self.logs()))
        return done.stdout if exit_code == 0 else done.stderr

    def logs(self):
        return "".join("\n%s: %s" % (path.name, path.read_text()[-400:]) for path in sorted(self.folder.glob("log/*")))

    def state(self):
        return dict(line.split(maxsplit=1) for line in self("status").splitlines())

    def __enter__(self):
        self.flow.folder.chmod(0o711)  # PostgreSQL runs as another user where this is root
        return self

    def __exit__(self, *_):
        self("down")
        running = {name: what for name, what in self.state().items() if what != "does not run"}
        check(not running, "all ends: %r" % running)
        self.flow.temporary.cleanup()


def on_sqlite():
    with Flow() as flow:
        push(flow)
        return told(flow)


def killed_and_gone_on(flow, cluster):
    state = cluster.state()
    check(state["db-1"] == "primary" and state["db-2"] == "standby", "a primary with its standby: %r" % state)
    flow.address = state["server-2"].rstrip("/")
    push(flow)
    cluster("kill", "server-1")
    cluster("kill", "worker-1")
    cluster("start", "worker-4")
    cluster("stop", "worker-2")
    answers = told(flow)  # by the server that goes on
    check("the primary, db-1, runs" in cluster("fail-over", exit_code=REFUSED), "there is no second primary")
    cluster("kill", "db-1")
    check("db-2 is the primary now" in cluster("fail-over"), "the standby takes its place")
    push_edges(flow, 3)
    check(told(flow) == answers, "the same after the fail-over: %r" % told(flow))
    cluster("start", "db-1")
    cluster("start", "server-1")
    state = cluster.state()
    check((state["db-1"], state["db-2"], state["worker-1"], state["worker-4"]) == ("standby", "primary", "does not run", "runs"), "as was asked: %r" % state)
    flow.address = state["server-1"].rstrip("/")
    check(told(flow) == answers, "the same by the server that came back")
    flow.rigcal("audit", "verify")
    return answers


def main():
    if not list(pathlib.Path("/usr/lib/postgresql").glob("*/bin/initdb")):
        print("SKIPPED: PostgreSQL is not installed (apt-get install postgresql-15)")
        raise SystemExit(SKIPPED)
    flow = Flow()
    with Cluster(flow) as cluster:
        cluster("up")
        answers = killed_and_gone_on(flow, cluster)
    check(answers == on_sqlite(), "the same ids and digests as on SQLite")


main()
