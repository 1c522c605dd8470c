"""Two servers on one tag: the second ends and names the first, or waits and takes over; two that meet again part."""
import contextlib
import pathlib
import signal
import sys
import threading
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edges_files import block_edges  # noqa: E402
from flow import Flow, check  # noqa: E402
from measures.server import Server  # noqa: E402

PATIENCE_S = 60


def line_of(server):
    return server.process.stdout.readline()


def await_line(server, word):
    """The next line of a server that has one in it; whoever waits too long fails."""
    timer = threading.Timer(PATIENCE_S, server.process.kill)
    timer.start()
    try:
        line = line_of(server)
        while line and word not in line:
            line = line_of(server)
    finally:
        timer.cancel()
    check(word in line, "a line with '%s' came, not %r" % (word, line))
    return line


def log_of(server):
    return open(str(server.data) + ".log").read()


def ended(server):
    return server.process.wait(timeout=PATIENCE_S)


def a_second_one_ends(flow):
    second = Server(flow.context, flow.folder / "second", flow.server.tag)
    second.start()
    code = ended(second)
    said = log_of(second)
    second.close()
    check(code == 4, "the second server ends with exit code 4, not %d: %s" % (code, said))
    check("(process %d, data in %s)" % (flow.server.process.pid, flow.server.data) in said, "it names the first: " + said)
    check("--standby" in said and "--tag" in said, "it says what to do: " + said)
    flow.rigcal("status")


def two_at_once(flow):
    """Started together, on a tag of their own: exactly one serves."""
    servers = [Server(flow.context, flow.folder / name, flow.server.tag + "-at-once") for name in ("x", "y")]
    for server in servers:
        server.start()
    lines = [line_of(server) for server in servers]  # empty where it ended
    check(sum("ready" in line for line in lines) == 1, "one of two serves: %r" % lines)
    loser = servers[0] if not lines[0] else servers[1]
    check(ended(loser) == 4, "the other ended with exit code 4")
    for server in servers:
        server.stop()


def asked(address):
    try:
        with urllib.request.urlopen(address, timeout=20) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def says_nothing_else(flow, standby, address):
    """Whatever is asked for, and whoever asks: neither a file, nor where the other one is."""
    pid = standby.process.pid
    for path in ("/healthz", "/readyz", "/", "/metrics", "/api/v1/status", "/robots/proc/revisions/%d/status" % pid, "/robots/proc/revisions/%d/root/etc/passwd" % pid):
        status, text = asked(address + path)
        check(status == 503 and "on standby" in text, "%s: %d %s" % (path, status, text))
        check(str(flow.server.process.pid) not in text and str(flow.server.data) not in text, "strangers are told no more: " + text)


def one_on_standby_takes_over(flow):
    standby = Server(flow.context, flow.folder / "standby", flow.server.tag)
    with contextlib.chdir("/"):  # where a file that is looked for in no folder would be
        standby.start("--standby")
    line = await_line(standby, "on standby")
    check("process %d," % flow.server.process.pid in line, "whoever started it is told for whom it waits: " + line)
    says_nothing_else(flow, standby, [word for word in line.split() if word.startswith("http://")][0].removesuffix("/healthz"))
    check(not (standby.data / "rigcal.db").exists(), "a server on standby opens no store")
    flow.rigcal("status")  # it is no second server to a client
    flow.server.kill()
    await_line(standby, "ready")
    path = block_edges(flow.folder / "edges.json", 3)
    done = standby.rigcal("push-edges", path, "--robot", "rig", "--no-wait")
    check(done.returncode == 0, "the other serves: " + done.stderr)
    return standby


def two_that_meet_again(flow, standby):
    """The first comes back; it is stopped like a machine that the network lost, and let go when another has its place."""
    flow.server.start("--standby")
    await_line(flow.server, "on standby")
    standby.process.send_signal(signal.SIGSTOP)
    await_line(flow.server, "ready")
    standby.process.send_signal(signal.SIGCONT)
    code = ended(flow.server)
    check(code == 4 and "came later and ends" in log_of(flow.server), "the later one ends: %d %s" % (code, log_of(flow.server)))
    check(standby.rigcal("robots", "--json").returncode == 0, "the earlier one goes on")
    standby.stop()


def main():
    with Flow() as flow:
        a_second_one_ends(flow)
        two_at_once(flow)
        standby = one_on_standby_takes_over(flow)
        two_that_meet_again(flow, standby)
    print("two_servers: good")


main()
