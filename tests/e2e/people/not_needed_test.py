"""Partial knowledge is a result, and the policy says whether it is enough: a sensor of which nobody measured how high it sits,
on a robot that needs no height."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402

PASS, REFUSED, UNKNOWN = 0, 4, 6  # exit codes
Z = 2


def level_edge(a, b, x_m):
    """It says nothing along z."""
    made = edge(a, b, x_m)
    information = [list(row) for row in made["information"]]
    information[Z][Z] = 0.0
    return {**made, "information": information}


def set_policy(flow, text, exit_code, reason="it drives on a level floor"):
    path = flow.folder / "policy.yaml"
    path.write_text(text)
    return flow.rigcal("policy", "set", path, "--robot", "level", "--reason", reason, exit_code=exit_code)


def check_unknown(flow):
    path = flow.folder / "edges.json"
    edges = [edge("left", "right", 1.0), edge("right", "top", 1.0), edge("left", "top", 2.0), level_edge("left", "wheels", 0.5), level_edge("right", "wheels", -0.5)]
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    said = flow.rigcal("push-edges", path, "--robot", "level", exit_code=UNKNOWN).stdout
    check("Not verified: do not rely on wheels" in said and "position along z of wheels" in said, "by default all is needed: " + said)


def check_enough(flow):
    said = set_policy(flow, "sensors:\n  wheels: {not_needed: [z of left]}\n", PASS).stdout
    check("OK to drive until" in said, "the rest is enough: " + said)
    check("The position along z of wheels in the frame of left was not measured, and the policy does not need it; the rest was, to" in said
          or "The position along z of wheels was not measured, and the policy does not need it; the rest was, to" in said, "it is told: " + said)
    flow.rigcal("status", "level", exit_code=PASS)
    shown = flow.rigcal("show", "level", exit_code=PASS).stdout
    check("z not measured" in shown, "five numbers and no sixth: " + shown)
    check("wheels: not_needed z of left" in flow.rigcal("policy", "show", "level").stdout, "the policy says so")
    document = json.loads(flow.get("/api/v1/show?robot=level"))["document"]
    wheels = [row for row in document["sensors"] if row["id"] == "wheels"][0]
    check(not wheels["known"] and wheels["measured_part"], "documents tell it as it is: %r" % wheels)


def check_taken_back(flow):
    set_policy(flow, "sensors:\n  wheels: {not_needed: [x of left]}\n", UNKNOWN, "the other axis")
    set_policy(flow, "sensors:\n  wheels: {not_needed: [z of left], tolerance_mm: 0.5}\n", UNKNOWN, "the rest has to be known")
    refused = set_policy(flow, "not_needed: [heigth]\n", REFUSED).stderr
    check('"heigth" is no result of a pose; did you mean "height"?' in refused, "a slip: " + refused)
    refused = set_policy(flow, "not_needed: [z]\n", REFUSED).stderr
    check('"z" is another axis with another reference sensor' in refused, "whose axis: " + refused)
    flow.kill_and_restart()
    flow.rigcal("show", "level", exit_code=UNKNOWN)


def main():
    with Flow() as flow:
        check_unknown(flow)
        check_enough(flow)
        check_taken_back(flow)
    print("not_needed: good")


main()
