"""Who is told of changes. A receiver that is down, one that fails first, and a server that is killed in between: each alert arrives at least
once, signed, in the order of its robot, and with an id by which repeats are known; a receiver that is down holds up no other."""
import json
import os
import pathlib
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402
from receiver import SECRET, Receiver  # noqa: E402

ROBOT = "rig"
FAIL = 1


def until(what, true, seconds=90):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if true():
            return
    check(False, what)


def start(flow, *ports):
    secret = flow.folder / "secret"
    secret.write_text(SECRET + "\n")
    hooks = [word for port in ports for word in ("--webhook", "http://127.0.0.1:%d/rigcal?token=hidden" % port)]
    flow.server.start(*hooks, "--webhook-secret-file", str(secret))
    flow.address = flow.ready()


def push(flow, ab_m, more=(), exit_code=None):
    path = flow.folder / "edges.json"
    edges = [edge("a", "b", ab_m), edge("b", "c", 1.0), edge("a", "c", 1.0 + ab_m), *more]
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    flow.rigcal("push-edges", path, "--robot", ROBOT, exit_code=exit_code)


def kinds(alerts):
    return [alert["kind"] for alert in alerts]


def once(alerts):
    """Without repeats, in the order of their first arrival."""
    return list({alert["id"]: alert for alert in alerts}.values())


def what_waits(flow):
    told = flow.server.rigcal("webhooks", "--json")
    return {row["url"]: row for row in json.loads(told.stdout)["webhooks"]}, told.returncode


def a_receiver_that_is_down_holds_up_no_other(flow, up, down_port):
    push(flow, 1.0)
    push(flow, 1.0, more=[edge("a", "c", 9.0)], exit_code=FAIL)
    until("the one that is there has the approval and the status", lambda: "approved" in kinds(up.taken) and any(
        alert["data"].get("status") == "failed" for alert in up.taken))
    status = [alert for alert in up.taken if alert["kind"] == "status"][-1]
    check(status["robot"] == ROBOT and status["data"]["status"] == "failed" and status["data"]["next_step"], "status: %r" % status)
    shown = "http://127.0.0.1:%d/rigcal" % down_port
    until("what waits says why", lambda: what_waits(flow)[0][shown]["last_error"])
    until("as much waits as the other has", lambda: what_waits(flow)[0][shown]["waiting"] == len(up.taken))
    waiting, code = what_waits(flow)
    check(code == FAIL and waiting[shown]["waiting"] == len(up.taken) and waiting[shown]["delivered"] == 0, "what waits: %r" % waiting)
    told = flow.rigcal("webhooks", exit_code=FAIL).stdout
    check(shown in told and "token" not in told and "no answer" in told, "in words, without its secret: " + told)
    metrics = flow.get("/metrics")
    check('rigcal_webhook_waiting{url="%s"} %d\n' % (shown, len(up.taken)) in metrics, "/metrics: " + metrics)
    check('rigcal_robots_by_status{status="failed"} 1\n' in metrics, "/metrics: " + metrics)
    check(json.loads(flow.get("/healthz"))["state"] == "ok", "a receiver that is down is no illness of the server")


def what_waited_arrives(flow, up, down_port):
    """After a kill -9; the receiver fails at first, then it kills the server before it answers."""
    flow.server.kill()
    asked = []

    def answer(alert):
        asked.append(alert["id"])
        if len(asked) <= 2:
            return 500
        if len(asked) == 3:
            os.kill(flow.server.process.pid, signal.SIGKILL)
            return None
        return 204
    late = Receiver(answer, down_port)
    start(flow, up.port, down_port)
    until("it is asked three times", lambda: len(asked) >= 3)
    check(len(set(asked)) == 1, "the first of its robot goes first, again and again: %r" % asked)
    flow.server.kill()
    start(flow, up.port, down_port)
    until("all arrives: %r of %r" % (late.taken, up.taken), lambda: {alert["id"] for alert in late.taken} >= {alert["id"] for alert in up.taken})
    check([alert["id"] for alert in once(late.taken)] == [alert["id"] for alert in once(up.taken)], "in the order in which it happened")
    check(asked.count(asked[2]) >= 4, "what was not answered came again, with its id")
    until("nothing waits", lambda: all(row["waiting"] == 0 for row in what_waits(flow)[0].values()))
    check(what_waits(flow)[1] == 0, "and nothing is wrong")
    return late


def decisions_are_told(flow, receivers):
    flow.rigcal("reject", ROBOT, 1, "--reason", "no, not that one", "--by", "Ada")
    flow.rigcal("approve", ROBOT, 1, "--reason", "after all", "--by", "Eve")
    for one in receivers:
        until("both are told: %r" % kinds(one.taken), lambda: kinds(once(one.taken))[-2:] == ["rejected", "approved"])
        last = once(one.taken)[-1]["data"]
        check(last == {"revision": 1, "who": "Eve", "reason": "after all"}, "who and why: %r" % last)
        check(not one.wrong, "each is signed: %r" % one.wrong)


def due_dates_are_a_calendar(flow):
    text = flow.get("/due.ics")
    check(flow.rigcal("due", "--ics").stdout == text.replace("\r\n", "\n"), "one calendar, by both ways")
    check("UID:rig.calibration@rigcal\r\n" in text and text.endswith("END:VCALENDAR\r\n"), "the robot is in it: " + text)
    try:
        import icalendar
    except ImportError:
        print("no python3-icalendar: the calendar was not read by another reader")
        return
    events = icalendar.Calendar.from_ical(text).walk("VEVENT")
    check(len(events) == 1 and str(events[0]["uid"]) == "rig.calibration@rigcal", "another reader reads it")


def refused(flow):
    flow.server.stop()
    for arguments in (["--webhook", "http://127.0.0.1:1/"], ["--webhook", "file:///etc/passwd", "--webhook-secret-file", str(flow.folder / "secret")]):
        flow.server.start(*arguments)
        flow.server.process.wait(timeout=60)
        check(flow.server.process.returncode == 1, "%r is refused" % arguments)
        flow.server.close()


def main():
    os.environ["no_proxy"] = "127.0.0.1"
    flow = Flow()
    up, nobody = Receiver(lambda alert: 200), Receiver(lambda alert: 200)
    nobody.stop()
    try:
        start(flow, up.port, nobody.port)
        a_receiver_that_is_down_holds_up_no_other(flow, up, nobody.port)
        late = what_waited_arrives(flow, up, nobody.port)
        decisions_are_told(flow, (up, late))
        due_dates_are_a_calendar(flow)
        refused(flow)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("alerts: good")


main()
