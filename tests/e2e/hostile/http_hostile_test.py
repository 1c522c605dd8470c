"""Every hostile act over HTTP is refused or bounded, others are answered meanwhile, and nothing of it lasts."""
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import http_acts  # noqa: E402
import login_acts  # noqa: E402
from flow import Flow, check  # noqa: E402


def connections(flow):
    return http_acts.connections(flow.server.process.pid)


def refused_at_start(flow):
    """An address that others reach, without being told that they may read; and with it, what everybody is told."""
    flow.server.stop()
    flow.server.start("--http", "0.0.0.0:0")
    flow.server.process.wait(timeout=60)
    check(flow.server.process.returncode == 1, "an open address ends it: %r" % flow.server.process.returncode)
    flow.server.stop()
    said = pathlib.Path(str(flow.server.data) + ".log").read_text()
    check("Add --http-open" in said, "and says why: " + said[-300:])
    flow.server.start("--http", "0.0.0.0:0", "--http-open")
    port = int(flow.ready().rsplit(":", 1)[1])
    for target in ("/", "/boards/", "/none"):
        page = http_acts.exchange(port, http_acts.request(target))
        check(b"Anyone on this network can read" in page, "%s says that the network reads it" % target)
    said = pathlib.Path(str(flow.server.data) + ".log").read_text()
    check("anyone on the network can read all reports" in said, "the log says it")


def main():
    with Flow() as flow:
        port = int(flow.address.rsplit(":", 1)[1])
        check(http_acts.seconds_of_question(port) < 10, "it answers")
        http_acts.put_large_file(flow.server.data)
        before, rss = connections(flow), flow.server.rss_mib()
        wrong = ["%s: %s" % (name, problem) for name, problem in http_acts.run_sent(port) if problem]
        check(not wrong, "refused or bounded: " + "; ".join(wrong))
        for name, seconds in http_acts.run_lasting(port, 20):
            check(seconds[-1] < 3, "others are answered during %s: %.2f s" % (name, seconds[-1]))
        until = time.monotonic() + 20
        while connections(flow) > before + 8 and time.monotonic() < until:
            http_acts.seconds_of_question(port)
        check(connections(flow) <= before + 8, "connections: %d before, %d after" % (before, connections(flow)))
        check(flow.server.rss_mib() - rss < 100, "memory: %.0f MiB more" % (flow.server.rss_mib() - rss))
        wrong = ["%s: %s" % one for one in login_acts.run(flow.server, port) if one[1]]
        check(not wrong, "about logins, refused: " + "; ".join(wrong))
        statuses, seconds = login_acts.flood(port, 20)
        check(set(statuses) == {403, 429} and statuses.count(403) <= 20, "guesses are slowed down: %r" % statuses)
        check(seconds[-1] < 3, "others are answered meanwhile: %.2f s" % seconds[-1])
        for name in ("ada", "vic"):
            login_acts.keep(flow.server, "user", "remove", name)
        refused_at_start(flow)
    print("http_hostile: good, %d acts" % (len(http_acts.SENT) + len(http_acts.LASTING)))


main()
