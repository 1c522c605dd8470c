"""May the robot drive? How each verb ends, which revision is kept where the newest failed, and that what is overdue says so first;
the same after the server was killed."""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check, wait_published  # noqa: E402
from measures.sessions import noise_session  # noqa: E402

PASS, FAIL, WARN, UNKNOWN = 0, 1, 5, 6  # exit codes
TRIANGLE = [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.0)]
CONTRADICTION = [edge("a", "c", 3.0)]
LONG_AGO = "2020-01-01T12:00:00Z"
OVERDUE = "Not verified: do not rely on it, overdue since 31 Mar 2020; capture again."


def push(flow, robot, edges, exit_code):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return flow.rigcal("push-edges", path, "--robot", robot, exit_code=exit_code).stdout


def check_codes(flow, robot, code, in_use=None):
    """Every verb that tells the verdict of one robot ends alike; `lookup` is of the revision in use."""
    for words in (("show", robot), ("status", robot), ("show", robot, "--json")):
        flow.rigcal(*words, exit_code=code)
    flow.rigcal("lookup", robot, "a", "c", exit_code=code if in_use is None else in_use)
    flow.rigcal("robots")


def check_all(flow, code):
    """Of all robots that of the worst."""
    flow.rigcal("status", exit_code=code)


def failed_keeps_the_last_good(flow):
    push(flow, "rig", TRIANGLE, PASS)
    check_codes(flow, "rig", PASS)
    check_all(flow, PASS)
    check(re.match(r"rig, .*\nOK to drive until \d+ \w+ 20\d\d\.\n", flow.rigcal("show", "rig").stdout), "until when it may drive")
    said = push(flow, "rig", CONTRADICTION, FAIL)
    keep = re.search(r"Robots that listen still have revision 1, measured \d+ \w+ 20\d\d: do not rely on it, either, until this is cleared up\.", said)
    check(keep, "push says what to keep: " + said)
    flow.kill_and_restart()
    check_codes(flow, "rig", FAIL, in_use=UNKNOWN)
    check_all(flow, FAIL)
    check(flow.rigcal("show", "rig", exit_code=FAIL).stdout.split("\n")[1] == "Do not drive.", "and that it may not")
    wait_published(flow)
    for told in (flow.rigcal("show", "rig", exit_code=FAIL).stdout, flow.get("/robots/rig/"), flow.get("/robots/rig/revisions/2/"), flow.get("/")):
        check(keep.group() in told, "all say what to keep: " + told)
    for verb in ("show?robot=rig", "status?robot=rig"):
        document = json.loads(flow.get("/api/v1/" + verb))
        usable = (document if "usable" in document else document["robots"][0])["usable"]
        check(usable["revision"] == 1, "%s: %r" % (verb, usable))
    check("There is no earlier calibration to fall back to." in push(flow, "new", TRIANGLE[:2] + CONTRADICTION, FAIL), "nothing to keep")


def warn_and_unknown(flow):
    push(flow, "open", TRIANGLE[:2], WARN)
    check_codes(flow, "open", WARN)
    session = noise_session(flow.folder / "noise", "noise", 100_000, 4, seed=1)
    flow.rigcal("push", session, exit_code=UNKNOWN)
    flow.rigcal("show", "noise", exit_code=UNKNOWN)
    one = noise_session(flow.folder / "one", "one", 100_000, 4, seed=2)
    text = (one / "session.yaml").read_text().replace("sees: board}\n  right: {type: camera, sees: board}", "sees: board}")
    (one / "session.yaml").write_text(text)
    for picture in (one / "right").iterdir():
        picture.unlink()
    (one / "right").rmdir()
    check("there is no result" in flow.rigcal("push", one, exit_code=UNKNOWN).stdout, "one camera alone")
    flow.rigcal("push", one, "--no-wait", exit_code=PASS)


def nothing_of_the_newest_visit(flow):
    """What older measurements know stays, and nobody takes the visit for one that calibrated something."""
    loop = [edge("left", "right", 1.0), edge("right", "top", 1.0), edge("left", "top", 2.0)]
    push(flow, "capped", loop, PASS)
    said = flow.rigcal("push", noise_session(flow.folder / "capped", "capped", 100_000, 4, seed=3), exit_code=WARN).stdout
    check("\nNothing of this session could be calibrated (1 pair): what follows is what older ones of the robot know.\nOK to drive; " in said,
          "the push says so first: " + said)
    flow.rigcal("show", "capped", exit_code=WARN)
    flow.rigcal("status", "capped", exit_code=WARN)


def two_cameras(flow):
    """Of the virtual robot, the cameras to the front: few captures, small pictures."""
    head, sensors = flow.rigcal("simulate", "--print-rig", "mars-mapper").stdout.split("\nsensors:\n")
    front = "".join(re.findall(r"(?m)^  front_\w+:\n(?:    .*\n|     .*\n)+", sensors))
    rig = flow.folder / "front.yaml"
    rig.write_text(head.replace("robot: mars-mapper", "robot: old") + "\nsensors:\n" + front)
    flow.rigcal("simulate", rig, "--out", flow.folder / "old", "--seed", 1, "--captures", 12, "--scale", 0.3, "--captured-at", LONG_AGO)
    return flow.folder / "old"


def overdue_comes_first(flow):
    said = flow.rigcal("push", two_cameras(flow), exit_code=UNKNOWN).stdout
    check(said.index(OVERDUE) < said.index("verdict  "), "push: " + said)
    shown = flow.rigcal("show", "old", exit_code=UNKNOWN).stdout
    check(shown.splitlines()[1] == OVERDUE and "OK to drive" not in shown, "show: " + shown)
    check(shown.splitlines()[0].startswith("old, revision 1, calibrated 1 Jan 2020, solved"), "when it was measured: " + shown)
    check("overdue, warn" in flow.rigcal("robots").stdout, "robots")
    for path in ("/api/v1/robots", "/api/v1/status?robot=old"):
        row = [one for one in json.loads(flow.get(path))["robots"] if one["robot"] == "old"][0]
        check(row["overdue"] and row["valid_until"] == "2020-03-31T12:00:00Z", "%s: %r" % (path, row))
        check(row["drive"] == {"kind": "not_verified", "rule": OVERDUE.rstrip("."), "until": None}, "%s: %r" % (path, row))
    page, fleet = flow.get("/robots/old/"), flow.get("/?q=old")
    check(page.index(OVERDUE) < page.index('class="word"'), "the page says so first")
    check('<span class="badge warn">overdue</span>' in fleet[fleet.index('href="robots/old/"'):].split('class="why"')[0], "so does the row, in amber")
    wait_published(flow)
    check(" by 31 Mar 2020.</p>" in flow.get("/robots/old/revisions/1/"), "a report that is made once says until when")
    flow.rigcal("due", exit_code=1)


def main():
    with Flow() as flow:
        failed_keeps_the_last_good(flow)
        warn_and_unknown(flow)
        nothing_of_the_newest_visit(flow)
        overdue_comes_first(flow)
    print("validity: good")


main()
