"""Stored sessions computed again: a board was measured anew, the robots that it was shown to are re-computed, and the server is killed while
it does so. Asked twice it is one run; what comes out is a candidate that is held, with what it would change, until a person approves it."""
import json
import pathlib
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, stereo_pairs, wait_published  # noqa: E402
from measures.sessions import picture_session  # noqa: E402

ROBOTS, SERIAL = ("rig-1", "rig-2", "rig-3"), "B-7"
WHAT = ("--type", "checkerboard", "--cols", 9, "--rows", 6, "--square-mm", 25)
REFUSED = 4


def with_serial(session):
    text = (session / "session.yaml").read_text()
    changed, count = re.subn(r"(square_size_m: *[0-9.]+)", r"\1, serial: %s" % SERIAL if "{" in text else r"\1\n    serial: %s" % SERIAL, text, count=1)
    check(count == 1, "session.yaml names a size: " + text)
    (session / "session.yaml").write_text(changed)
    return session


def states(flow, robot):
    rows = json.loads(flow.rigcal("history", robot, "--json").stdout)["revisions"]
    return {row["revision"]: row["state"] for row in rows}


def in_use(flow, robot):
    used = [number for number, state in states(flow, robot).items() if state == "approved"]
    check(len(used) == 1, "one revision of %s is in use: %r" % (robot, states(flow, robot)))
    return used[0]


def right_x_m(flow, robot, number):
    return json.loads(flow.rigcal("lookup", robot, "left", "right", "--revision", number, "--json").stdout)["T_a_b"]["p_m"][0]


def unchanged_by_the_same_software(flow):
    said = flow.rigcal("resolve", ROBOTS[0], "--by", "Ada").stdout
    check("1 session: 1 computed so before. 1 robot: 1 unchanged." in said and "unchanged: rig-1" in said, "nothing changes: " + said)
    again = json.loads(flow.rigcal("resolve", ROBOTS[0], "--by", "Bob", "--json").stdout)
    check(again["run"] == 1 and again["who"] == "Ada", "asked twice it is one run: %r" % again)


def killed_on_the_way(flow):
    refused = flow.rigcal("resolve", "--board", SERIAL, exit_code=REFUSED).stderr
    check("nobody measured board" in refused, "which size? " + refused)
    flow.rigcal("board", "measure", SERIAL, "--ruler-x-mm", 199.4, "--ruler-y-mm", 199.4, "--sigma-mm", 0.05, *WHAT)
    asked = json.loads(flow.rigcal("resolve", "--board", SERIAL, "--by", "Ada", "--no-wait", "--json").stdout)
    until = time.monotonic() + 300
    seen = []
    while time.monotonic() < until and len(seen) < len(ROBOTS) + 1:
        told = json.loads(flow.server.rigcal("resolve", "--status", "--no-wait", "--json").stdout)
        check(told["run"] == asked["run"], "the run is there after a kill: %r" % told)
        if told["sessions"]["done"] not in seen:
            check(not seen or told["sessions"]["done"] >= max(seen), "nothing that was done is lost: %r, then %r" % (seen, told))
            seen.append(told["sessions"]["done"])
            flow.kill_and_restart()
        if told["done"]:
            break
    check(len(seen) > 1, "it was killed amid the run: %r" % seen)
    twice = json.loads(flow.rigcal("resolve", "--board", SERIAL, "--by", "Eve", "--json").stdout)
    check(twice["run"] == asked["run"] and twice["who"] == "Ada", "asked twice it is one run: %r" % twice)
    check(twice["sessions"] == {"total": 3, "done": 3, "computed": 3, "same": 0, "kept": 0, "failed": 0}, "each once: %r" % twice["sessions"])
    return twice


def held_until_approved(flow, told, before):
    check([row["how"] for row in told["robots"]] == ["changed"] * len(ROBOTS), "each changes: %r" % told["robots"])
    for row in told["robots"]:
        robot, candidate = row["robot"], row["revision"]
        check(in_use(flow, robot) == before[robot] == row["against"] and states(flow, robot)[candidate] == "candidate", "held: %r" % states(flow, robot))
        change = row["changes"][0]
        moved_m = abs(right_x_m(flow, robot, candidate) - right_x_m(flow, robot, before[robot]))
        check(change["sensor"] == "right" and moved_m > 1.5e-4 and change["moved_m"] > 0.9 * moved_m, "squares smaller by 0.3 %%: %r, %g m" % (change, moved_m))
        ratio = right_x_m(flow, robot, candidate) / right_x_m(flow, robot, before[robot])
        check(abs(ratio - 0.997) < 0.0007, "and so is the baseline: %g" % ratio)
    shown = flow.rigcal("show", ROBOTS[0]).stdout
    check("this one is a candidate, re-computed with rigcal " in shown and "board B-7 with its measured size" in shown, "the cause stands on it: " + shown)
    policy = flow.folder / "policy.yaml"
    policy.write_text("tolerance_mm: 30\n")
    flow.rigcal("policy", "set", policy, "--robot", ROBOTS[0], "--reason", "wide mounts", exit_code=6)  # the newest of it is a candidate: not verified
    check(in_use(flow, ROBOTS[0]) == before[ROBOTS[0]], "a policy that is set approves nothing of it")
    candidate = next(row["revision"] for row in told["robots"] if row["robot"] == ROBOTS[0])
    flow.rigcal("approve", ROBOTS[0], candidate, "--reason", "the rule was right", "--by", "Eve")
    check(in_use(flow, ROBOTS[0]) == candidate, "a person does")
    check(in_use(flow, ROBOTS[1]) == before[ROBOTS[1]], "of that robot alone")
    check(flow.rigcal("audit", "verify").stdout.startswith("The audit is as it was written: "), "the audit holds")


def main():
    with Flow() as flow:
        for robot in ROBOTS:
            flow.rigcal("push", with_serial(picture_session(flow.folder / robot, robot, stereo_pairs(flow.context))), "--new-robot")
        wait_published(flow)
        before = {robot: in_use(flow, robot) for robot in ROBOTS}
        unchanged_by_the_same_software(flow)
        held_until_approved(flow, killed_on_the_way(flow), before)
    print("resolve: good")


main()
