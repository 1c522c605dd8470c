"""Hostile acts over HTTP (tests/e2e/hostile/http_acts.py): refused or bounded, and what others wait meanwhile."""
import pathlib
import sys
import time

from ..measure import at_least, at_most, equal
from ..server import Server

E2E = pathlib.Path(__file__).resolve().parents[3] / "tests" / "e2e"
QUESTIONS = 200


def p99(sorted_seconds):
    return sorted_seconds[len(sorted_seconds) * 99 // 100]


def settled(count, at_most_wanted):
    """count() once it is no more than wanted, or after 20 s."""
    until = time.monotonic() + 20
    while count() > at_most_wanted and time.monotonic() < until:
        time.sleep(0.2)
    return count()


def run(context):
    sys.path.insert(0, str(E2E / "hostile"))
    import http_acts
    import login_acts
    with context.folder() as temporary, Server(context, pathlib.Path(temporary) / "store") as server:
        port = int(server.address.rsplit(":", 1)[1])
        http_acts.put_large_file(server.data)
        quiet = sorted(http_acts.seconds_of_question(port) for _ in range(QUESTIONS))
        def connections():
            return http_acts.connections(server.process.pid)

        before, rss = connections(), server.rss_mib()
        outcomes = http_acts.run_sent(port)
        wrong = ["%s: %s" % one for one in outcomes if one[1]]
        yield at_least("acts", len(outcomes) + len(http_acts.LASTING), 25)
        yield equal("acts_not_refused_or_bounded", len(wrong), 0, detail=wrong)
        for name, seconds in http_acts.run_lasting(port, QUESTIONS):
            yield at_most("p99_of_others_during_%s_over_quiet" % name, p99(seconds) / p99(quiet), 2.0)
        yield at_most("connections_left", settled(connections, before + 4) - before, 4)
        yield at_most("memory_left", server.rss_mib() - rss, 64.0, "MiB")
        logins = login_acts.run(server, port)
        wrong = ["%s: %s" % one for one in logins if one[1]]
        yield at_least("acts_about_logins", len(logins), 20)
        yield equal("acts_about_logins_not_refused", len(wrong), 0, detail=wrong)
        statuses, seconds = login_acts.flood(port, QUESTIONS)
        yield at_most("guesses_of_a_flood_that_are_looked_at", sum(status == 403 for status in statuses), 20)
        yield equal("guesses_of_a_flood_that_are_answered_otherwise", sum(status not in (403, 429) for status in statuses), 0)
        yield at_most("p99_of_others_during_password_flood_over_quiet", p99(seconds) / p99(quiet), 2.0)
