"""Several servers on one PostgreSQL store and one folder: two on one network, of which one speaks DDS, and one on a network of its own. The
one that speaks is killed amid a push, and another stands still and wakes: the client goes on, nothing that had a receipt is lost, each
receiver has each alert once, each network is told what was decided on the other, and every id and digest is that of a quiet server."""
import contextlib
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from edge_case import edge  # noqa: E402
from flow import NOT_FAILED, ROOT, Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402
from measures.server import Server  # noqa: E402
from receiver import SECRET, Receiver  # noqa: E402

ROBOTS = ("rig-1", "rig-2", "rig-3")
PATIENCE_S = 120


def sessions(flow):
    """The first is larger than what may come without a receipt (window_bytes)."""
    for number, robot in enumerate(ROBOTS, 1):
        flow.rigcal("simulate", front_rig(flow, robot, robot), "--out", flow.folder / robot, "--seed", number, "--captures", 10, "--scale", 0.45 if number == 1 else 0.25,
                    "--captured-at", "2026-01-31T10:00:00Z")


def push(flow, server, robot):
    return subprocess.Popen(server.client("push", flow.folder / robot), env=server.environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def await_pushed(*pushes):
    for one in pushes:
        said, _ = one.communicate(timeout=2 * PATIENCE_S)
        check(one.returncode in NOT_FAILED, "a push ended with %d: %s" % (one.returncode, said))


def told(flow):
    wait_published(flow)
    answers = {}
    for robot in ROBOTS:
        shown = json.loads(flow.rigcal("show", robot, "--json").stdout)
        answers[robot] = (shown["digest"], [one["id"] for one in json.loads(flow.rigcal("edges", robot, "--json").stdout)["edges"]])
    return answers


def on_sqlite():
    with Flow() as flow:
        sessions(flow)
        await_pushed(*(push(flow, flow.server, robot) for robot in ROBOTS))
        return told(flow)


def psql(*arguments):
    return ["psql", "--quiet", "--no-psqlrc", "--tuples-only", "--no-align", os.environ["RIGCAL_STORE"], *arguments]


def query(sql):
    return subprocess.run(psql("--command", sql), check=True, capture_output=True, text=True).stdout.split("\n")[:-1]


def wait_until(what, holds):
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        if holds():
            return
        query("SELECT 1")  # however fast the other is
    check(False, what)


def await_line(process, word):
    """The next line with the word in it; whoever waits too long fails."""
    timer = threading.Timer(PATIENCE_S, process.kill)
    timer.start()
    line = process.stdout.readline()
    while line and word not in line:
        line = process.stdout.readline()
    timer.cancel()
    check(word in line, "a line with '%s' came, not %r" % (word, line))
    return line


@contextlib.contextmanager
def no_session_is_closed():
    """Meanwhile a commit that would close one waits, and all that were receipted before are held."""
    holder = subprocess.Popen(psql(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    holder.stdin.write("BEGIN;\nLOCK TABLE rigcal.session_closed IN SHARE MODE;\n\\echo locked\n")
    holder.stdin.flush()
    await_line(holder, "locked")
    yield
    holder.communicate()


class Servers:
    """Two on the network of the clients of `flow`, and one that is far from them."""

    def __init__(self, flow, receiver):
        self.flow = flow
        secret = flow.folder / "secret"
        secret.write_text(SECRET + "\n")
        self.arguments = ("--threads", "1", "--limit", "window_bytes=2MiB", "--webhook", "http://127.0.0.1:%d/" % receiver.port, "--webhook-secret-file", secret)
        tag = flow.server.tag
        self.speaks, self.stands_ready, self.far = (Server(flow.context, flow.server.data, of) for of in (tag, tag, tag + "-far"))

    def __enter__(self):
        for server in self.all():
            server.start(*map(str, self.arguments))  # together, on a database without a table
        lines = [self.ready(server) for server in self.all()]
        check(["DDS here is with" in line for line in lines] in ([False, True, False], [True, False, False]), "one of two speaks: %r" % lines)
        if "DDS here is with" in lines[0]:
            self.change()
        self.flow.server, self.flow.address = self.speaks, self.speaks.address
        return self

    def __exit__(self, *_):
        for server in self.all():
            if server.process:
                server.process.send_signal(signal.SIGCONT)
            server.stop()

    def all(self):
        return self.speaks, self.stands_ready, self.far

    def ready(self, server):
        line = await_line(server.process, "ready")
        server.address = [word for word in line.split() if word.startswith("http://")][0].rstrip("/")
        return line

    def change(self):
        self.speaks, self.stands_ready = self.stands_ready, self.speaks
        if hasattr(self.speaks, "address"):
            self.flow.server, self.flow.address = self.speaks, self.speaks.address

    def start_again(self):
        self.stands_ready.start(*map(str, self.arguments))
        check("DDS here is with" in self.ready(self.stands_ready), "whoever comes back stands ready")


def get(server, path):
    with urllib.request.urlopen(server.address + path, timeout=20) as reply:
        return reply.read()


def a_stranger_is_refused(flow):
    """A server of another store, on the network of these."""
    stranger = Server(flow.context, flow.folder / "stranger", flow.server.tag)
    stranger.start("--store", "sqlite:%s" % (flow.folder / "stranger"))
    code = stranger.process.wait(timeout=PATIENCE_S)
    stranger.close()
    check(code == 4, "a server of another store ends with exit code 4, not %d" % code)


def killed_amid_a_push(flow, servers):
    first = ROBOTS[0]
    with no_session_is_closed():
        pushed = push(flow, servers.speaks, first)
        wait_until("the session is about to be closed",
                   lambda: query("SELECT 1 FROM pg_locks WHERE NOT granted AND relation = 'rigcal.session_closed'::regclass"))
        servers.speaks.kill()
        killed = time.monotonic()
    held = query("SELECT count(*) FROM rigcal.payload_held")
    check(int(held[0]) > 0, "some of it had a receipt: %r" % held)
    servers.change()
    wait_until("all of it has a receipt", lambda: query("SELECT 1 FROM rigcal.session_closed"))
    print("all of it had a receipt %.1f s after the kill" % (time.monotonic() - killed))
    await_pushed(pushed)
    servers.start_again()


def on_both_networks_at_once(flow, servers):
    """One session comes by two servers at once."""
    await_pushed(push(flow, servers.speaks, ROBOTS[1]), push(flow, servers.far, ROBOTS[2]), push(flow, servers.speaks, ROBOTS[2]))


def one_that_stands_still_wakes(flow, servers):
    stalled = servers.speaks
    stalled.process.send_signal(signal.SIGSTOP)
    servers.change()
    flow.rigcal("robots", "--json", "--timeout", "60")  # whoever takes over answers
    stalled.process.send_signal(signal.SIGCONT)
    log = pathlib.Path(str(flow.server.data) + ".log")
    wait_until("one of them stands ready again", lambda: "this one stands ready" in log.read_text())
    servers.change()  # who came first goes first
    flow.rigcal("robots", "--json", "--timeout", "60")
    for server in servers.all():
        check(get(server, "/healthz"), "it is well")


def push_edges(flow, ab_m):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", ab_m), edge("b", "c", 1.0), edge("a", "c", 1.0 + ab_m)]}))
    flow.rigcal("push-edges", path, "--robot", "rig")


def order(flow, server, verb, **parameters):
    """Over HTTP, by a token."""
    def keep(*words, said=""):
        return subprocess.run(server.client(*words, "--data", server.data), input=said, capture_output=True, text=True, env=server.environment(), check=True).stdout
    keep("user", "add", "ada", "--role", "admin", said="correct horse battery\n")
    request = urllib.request.Request(server.address + "/api/v1/" + verb, json.dumps(parameters).encode(), {
        "Content-Type": "application/json", "Authorization": "Bearer " + keep("token", "new", "ops", "--role", "admin").strip()})
    with urllib.request.urlopen(request, timeout=20) as reply:
        return json.loads(reply.read())


def each_network_is_told(flow, servers):
    """A robot on the far network runs what is decided on the other one, and by a server that does not speak DDS."""
    agent = subprocess.Popen(servers.far.client("agent", "rig", "--out", flow.folder / "calibration.json"), env=servers.far.environment(), stdout=subprocess.PIPE, text=True)
    try:
        for revision, ab_m in ((1, 1.0), (2, 1.0002)):
            push_edges(flow, ab_m)
            await_line(agent, "is now revision %d" % revision)
        flow.rigcal("rollback", "rig", 1, "--reason", "the floor was soft")
        await_line(agent, "is now revision 1")
        order(flow, servers.stands_ready, "rollback", robot="rig", revision=2, reason="it was not")
        await_line(agent, "is now revision 2")
    finally:
        agent.terminate()
        agent.communicate()


def all_serve_the_same(flow, servers):
    """Reports are in the folder, whoever drew them; what is listed is in the database."""
    for robot in ROBOTS:
        pages = [get(server, "/robots/%s/revisions/1/" % robot) for server in servers.all()]
        check(len(pages[0]) > 10_000 and pages[0] == pages[1] == pages[2], "one report of " + robot)


def nothing_is_lost(flow):
    digests = query("SELECT DISTINCT digest FROM rigcal.payload")
    blobs = flow.server.data / "blobs"
    whole = [digest for digest in digests if hashlib.sha256((blobs / digest[:2] / digest).read_bytes()).hexdigest() == digest]
    check(len(whole) == len(digests) > 60, "%d of %d payloads are whole" % (len(whole), len(digests)))
    check(query("SELECT count(*), count(DISTINCT session_id) FROM rigcal.session") == ["3|3"], "each session is there once")


def each_alert_came_once(receiver):
    wait_until("every alert is delivered", lambda: query("SELECT count(*) FROM rigcal.waiting_alert") == ["0"])
    ids = [alert["id"] for alert in receiver.taken]
    stored = query("SELECT id FROM rigcal.alert WHERE number IN (SELECT alert_number FROM rigcal.alert_delivered)")
    check(sorted(ids) == sorted(stored) and len(ids) > 2 and not receiver.wrong, "each alert came once: %r, stored %r" % (ids, stored))


def on_postgres():
    server = os.environ["RIGCAL_TEST_POSTGRES"], os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]
    subprocess.run(["psql", "--quiet", "--no-psqlrc", server[0] + "postgres" + server[1], "--command", "CREATE DATABASE several"], check=True)
    os.environ["RIGCAL_STORE"] = server[0] + "several" + server[1]
    receiver = Receiver(lambda alert: 204)
    try:
        flow = Flow()
        sessions(flow)
        with Servers(flow, receiver) as servers:
            a_stranger_is_refused(flow)
            killed_amid_a_push(flow, servers)
            on_both_networks_at_once(flow, servers)
            answers = told(flow)
            all_serve_the_same(flow, servers)
            nothing_is_lost(flow)
            one_that_stands_still_wakes(flow, servers)
            each_network_is_told(flow, servers)
            each_alert_came_once(receiver)
        flow.temporary.cleanup()
        return answers
    finally:
        receiver.stop()
        del os.environ["RIGCAL_STORE"]


def main():
    if "RIGCAL_TEST_POSTGRES" not in os.environ:
        os.execv(ROOT / "tests/postgres/with_postgres", ["with_postgres", sys.executable, __file__])
    check(on_postgres() == on_sqlite(), "the same ids and digests as of one quiet server")


main()
