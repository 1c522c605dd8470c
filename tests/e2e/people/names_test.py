"""A misspelt name: what is asked about is told with what it may mean, and nothing is pushed under it unawares."""
import json
import pathlib
import shutil
import subprocess
import sys
import urllib.error

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402
from measures.sessions import noise_session  # noqa: E402

NEW = "rigcal: robot 'maper-01' is new, and mapper-01 is known: push with --new-robot if it is another robot."
UNKNOWN = "robot 'maper-01' is not known: did you mean mapper-01?"


def edges(folder):
    path = folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("front_left", "front_right", 1.0), edge("front_left", "top", 2.0)]}))
    return path


def robots(flow):
    return [row["robot"] for row in json.loads(flow.rigcal("robots", "--json").stdout)["robots"]]


def says_what_may_be_meant(flow):
    told = flow.rigcal("show", "maper-01", exit_code=4).stderr
    check(told.startswith("rigcal: " + UNKNOWN), "an unknown robot: " + told)
    told = flow.rigcal("lookup", "mapper-01", "front_lef", "top", exit_code=4).stderr
    check("robot 'mapper-01' has no sensor 'front_lef': did you mean front_left?" in told, "an unknown sensor: " + told)
    told = flow.rigcal("retire", "front_rigth", "--robot", "mapper-01", "--reason", "gone", exit_code=4).stderr
    check("robot 'mapper-01' has no sensor 'front_rigth': did you mean front_right?" in told, "a sensor to retire: " + told)
    told = flow.rigcal("show", "mapper-01", "--revision", "9" * 20, exit_code=2).stderr
    check("--revision = " + "9" * 20 + ": no number that can be taken here, or too large a one" in told, "a number: " + told)
    told = flow.rigcal("pusch", "visit/", exit_code=2).stderr
    check("there is no verb 'pusch': did you mean push?" in told, "an unknown verb: " + told)
    for path in ("/api/v1/show?robot=maper-01", "/robots/maper-01/"):
        try:
            flow.get(path)
            check(False, path + " is found")
        except urllib.error.HTTPError as refused:
            body = refused.read().decode().replace("&#39;", "'")
            check(refused.code == 404 and UNKNOWN[1:] in body, path + ": " + body)


def pushes_nothing_unawares(flow, path):
    session = noise_session(flow.folder / "noise", "maper-01", 1000, 4, seed=6)
    for command in (("push", session), ("push-edges", path, "--robot", "maper-01"), ("push", session, "--no-wait")):
        told = flow.rigcal(*command, exit_code=4).stderr
        check(told.startswith(NEW), "%s: %s" % (command[0], told))
        check(robots(flow) == ["mapper-01"], "nothing was stored")
    refused = json.loads(flow.rigcal("push", session, "--json", exit_code=4).stdout)
    check(refused["error"]["code"] == "conflict", "as JSON: %r" % refused)
    flow.rigcal("push-edges", path, "--robot", "mapper-02")  # another of the series
    flow.rigcal("push", session, "--new-robot")
    flow.rigcal("push", session)  # by now it is known
    check(robots(flow) == ["maper-01", "mapper-01", "mapper-02"], "three robots: %r" % robots(flow))


def an_agent_does_not_wait_unawares(flow):
    waiting = subprocess.Popen(flow.server.client("agent", "mappre-01", "--out", flow.folder / "calibration.json"), env=flow.server.environment(),
                               stderr=subprocess.PIPE, text=True)
    told = waiting.stderr.readline()
    waiting.terminate()
    waiting.communicate(timeout=60)
    check(told.startswith("Robot mappre-01 is not known, and mapper-01 is: this waits for what is approved of mappre-01."), "the agent: " + told)


def tells_both(flow):
    """Who answers for the name with --new-robot was told whose the pictures are."""
    copy = flow.folder / "copy"
    shutil.copytree(flow.folder / "noise", copy)
    (copy / "session.yaml").write_text((copy / "session.yaml").read_text().replace("maper-01", "maperr-01"))
    told = flow.rigcal("push", copy, exit_code=4).stderr
    check("robot 'maperr-01' is new, and maper-01 is known: push with --new-robot if it is another robot; also, 4 of 4 files looked "
          "at are the same as in the session of robot maper-01 of" in told, "both at once: " + told)
    bad = flow.folder / "bad.json"
    bad.write_text("{")
    told = flow.rigcal("push-edges", bad, "--robot", "mapper-01", exit_code=4).stderr
    check(told.startswith("rigcal: %s: edge file: line 1: not JSON" % bad), "which file: " + told)


def main():
    with Flow() as flow:
        path = edges(flow.folder)
        flow.rigcal("push-edges", path, "--robot", "mapper-01")
        says_what_may_be_meant(flow)
        pushes_nothing_unawares(flow, path)
        tells_both(flow)
        an_agent_does_not_wait_unawares(flow)
    print("names: good")


main()
