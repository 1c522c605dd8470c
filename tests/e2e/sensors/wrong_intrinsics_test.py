"""Two cameras whose intrinsics were pasted the wrong way round: the robot must not drive, both are named, on its page too, and poses and
lenses are those of the session all the same; with the lines exchanged back and pushed again it is verified. Loose mounts are told."""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from front_rig import THIRD, front_rig  # noqa: E402


def simulate(flow, robot, name, seed, captured_at, *more):
    rig = front_rig(flow, robot, name)
    rig.write_text(rig.read_text().replace(THIRD, ""))
    flow.rigcal("simulate", rig, "--out", flow.folder / name, "--seed", seed, "--captures", 20, "--scale", 0.3, "--captured-at", captured_at, *more)
    return flow.folder / name


def exchange_intrinsics(session):
    path = session / "session.yaml"
    text = path.read_text()
    left, right = re.findall(r"(?m)^    intrinsics: .*$", text)
    path.write_text(text.replace(left, "\0").replace(right, left).replace("\0", right))


def shown(flow, robot, exit_code=None):
    return json.loads(flow.rigcal("show", robot, "--json", exit_code=exit_code).stdout)


def error_m(flow, session, robot):
    """Of the camera that is not the reference, from the truth that the simulator wrote."""
    truth = re.search(r"(?ms)^  front_right:.*?T_ref_sensor: \{p_m: \[(.*?)\]", (session / "truth.yaml").read_text())
    true_m = [float(number) for number in truth.group(1).split(",")]
    [pose] = [one for one in shown(flow, robot, exit_code=1)["document"]["sensors"] if one["id"] == "front_right"]
    return max(abs(x - y) for x, y in zip(true_m, pose["T_ref_sensor"]["p_m"]))


def main():
    with Flow() as flow:
        session = simulate(flow, "exchanged", "wrong", 1, "2026-01-31")
        exchange_intrinsics(session)
        flow.rigcal("push", session, exit_code=1)
        document = shown(flow, "exchanged", exit_code=1)
        verdict = document["document"]["verdict"]
        check("ntrinsics of front_left and front_right are exchanged" in verdict["why"], "both are named: %r" % verdict)
        check("session.yaml" in verdict["what_to_do"] and "rigcal push FOLDER" in verdict["what_to_do"], "what to do: %r" % verdict)
        page = flow.get("/robots/exchanged/revisions/%d/" % document["revision"])
        check("front_left and front_right are exchanged" in page, "the report says so")
        check(error_m(flow, session, "exchanged") < 0.003, "poses are those of the session all the same")
        check("intrinsics given for" in flow.get("/") and "loops that do not close" not in flow.get("/"), "the fleet counts it by its cause")
        flow.kill_and_restart()
        check(shown(flow, "exchanged", exit_code=1)["document"]["verdict"] == verdict, "after a restart, too")
        exchange_intrinsics(session)
        flow.rigcal("push", session)
        mended = shown(flow, "exchanged")["document"]["verdict"]
        check("intrinsics" not in mended["why"], "pushed again with the right ones: %r" % mended)
        loose = simulate(flow, "loose", "rattling", 2, "2026-02-01", "--rattle", "0.5,0.03")
        flow.rigcal("push", loose)
        verdict = shown(flow, "loose")["document"]["verdict"]
        check("off as a whole from capture to capture" in verdict["why"] and "moved" not in verdict["why"], "loose mounts are told: %r" % verdict)
    print("wrong_intrinsics: good")


main()
