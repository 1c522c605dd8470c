"""Rig models, parts and epochs as a technician uses them: a camera that was exchanged is told by its serial number, a rig model names what the robot
lacks and what is off the drawing, and an epoch that was begun by hand outlives the server and is taken back."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOT, MODEL, EXCHANGED = "moved", "mars-mapper", "front_right"
WARN, UNKNOWN, REFUSED = 5, 6, 4


def visit(flow, name, seed, captured_at, moved_m, serial):
    folder = flow.folder / name
    flow.rigcal("simulate", front_rig(flow, ROBOT, name, moved_m), "--out", folder, "--seed", seed, "--captures", 20, "--scale", 0.3,
                "--captured-at", captured_at)
    session = folder / "session.yaml"
    text, title = session.read_text(), "  %s:\n" % EXCHANGED
    check(text.count(title) == 1, "the sensor is listed once")
    session.write_text(text.replace(title, "%s    serial: %s\n" % (title, serial)))
    return folder


def shown(flow):
    return json.loads(flow.server.rigcal("show", ROBOT, "--json").stdout)["document"]


def past(document):
    return sorted((edge["frame_a"], edge["frame_b"]) for edge in document["edges"]
                  if edge["state"] == "failed" and [one["code"] for one in edge["diagnoses"]] == ["epoch"])


def model_file(flow, document, off_m):
    """Drawn where it was measured, one camera beside that; and one that no robot has."""
    lines = ["rig_model: " + MODEL, "tolerance_mm: 10", "tolerance_deg: 1", "reference: " + document["reference"], "sensors:"]
    for sensor in document["sensors"]:
        T = sensor["T_ref_sensor"]
        if sensor["id"] == document["reference"]:
            lines.append("  %s: {type: camera}" % sensor["id"])
            continue
        p_m = [T["p_m"][0] + (off_m if sensor["id"] == EXCHANGED else 0.0)] + T["p_m"][1:]
        lines.append("  %s: {type: camera, T_ref_sensor: {p_m: %s, q_xyzw: %s}}" % (sensor["id"], json.dumps(p_m), json.dumps(T["q_xyzw"])))
    lines += ["  front_bottom: {type: camera}", "required_pairs: [[front_left, front_right]]"]
    path = flow.folder / "model.yaml"
    path.write_text("\n".join(lines) + "\n")
    return path


def an_exchanged_part(flow):
    flow.rigcal("push", visit(flow, "first", 1, "2026-01-31", 0.0, "A1"))
    second = json.loads(flow.rigcal("push", visit(flow, "second", 2, "2026-02-03", 0.008, "B7"), "--json").stdout)["id"]
    document = shown(flow)
    check(past(document) == [("front_left", EXCHANGED), (EXCHANGED, "front_top")], "what is past: %r" % past(document))
    check(document["verdict"]["level"] != "fail", "another part is elsewhere, and that is no contradiction: %r" % document["verdict"])
    told = flow.rigcal("history", ROBOT).stdout
    check("the serial number of front_right is B7, before it was A1" in told, "history says why: " + told)
    page = flow.get("/robots/moved/")
    check("the serial number of front_right is B7, before it was A1" in page, "so does the page")
    check("serial <bdi>B7</bdi>" in flow.get("/robots/moved/sessions/%s/" % second), "the session's page tells its parts")


def a_rig_model(flow):
    path = model_file(flow, shown(flow), 0.03)
    check("is good" in flow.rigcal("model", "check", path).stdout, "the file is good")
    slip = flow.folder / "slip.yaml"
    slip.write_text(path.read_text().replace("rig_model: mars-mapper", "rig_model: mars-maper"))
    check("did you mean mars-mapper" in flow.rigcal("model", "set", slip, "--reason", "x", exit_code=REFUSED).stderr, "a slip is refused")
    said = flow.rigcal("model", "set", path, "--reason", "drawing 7", "--by", "Ada").stdout
    check("Rig model mars-mapper is version 1, set by Ada.\n1 robot is judged anew" in said, "it was set: " + said)
    wait_published(flow)
    document = shown(flow)
    causes = {cause["kind"]: cause for cause in document["causes"]}
    check(causes["sensor_missing"]["why"] == "front_bottom is in rig model mars-mapper but not here.", "what is missing: %r" % causes)
    off = causes["off_rig_model"]
    check(off["sensors"] == [EXCHANGED] and off["why"].startswith("front_right sits 30") and off["why"].endswith("(10 mm and 1 deg allowed)."), "what is off: %r" % off)
    check(document["verdict"]["level"] == "warn" and "front_bottom is in rig model" in document["verdict"]["why"], "it warns: %r" % document["verdict"])
    check(document["policy"]["rig_model_version"] == 1, "the revision says by which version")
    flow.rigcal("model", "set", model_file(flow, document, 0.0), "--reason", "drawing 8")
    wait_published(flow)
    check("off_rig_model" not in [cause["kind"] for cause in shown(flow)["causes"]], "the corrected drawing fits")
    check("set version 2 of rig model mars-mapper" in flow.rigcal("audit").stdout, "the audit has it")
    told = flow.rigcal("fleet", MODEL).stdout
    check("5 are needed to tell how they scatter" in told, "one robot tells nothing of a spread: " + told)
    check("version 2" in flow.get("/models/mars-mapper/") and "mars-mapper" in flow.get("/models/"), "it has its page")


def an_epoch_by_hand(flow):
    said = flow.rigcal("epoch", ROBOT, "--sensor", "front_top", "--reason", "new bracket", "--by", "Ada", exit_code=UNKNOWN).stdout
    check("An epoch of front_top of moved began at " in said and "What was measured of it before is past." in said, "it was begun: " + said)
    flow.kill_and_restart()
    document = shown(flow)
    check(("front_left", "front_top") in past(document) and ("front_left", EXCHANGED) in past(document), "what is past now: %r" % past(document))
    check("an epoch of front_top was begun by Ada: new bracket" in flow.rigcal("history", ROBOT).stdout, "history says so")
    flow.rigcal("epoch", ROBOT, "--sensor", "front_top", "--take-back", "--reason", "it was another robot", exit_code=UNKNOWN)
    check(past(shown(flow)) == [("front_left", EXCHANGED), (EXCHANGED, "front_top")], "it is as if it had not been said")
    refused = flow.rigcal("epoch", ROBOT, "--sensor", "front_top", "--take-back", "--reason", "once more", exit_code=REFUSED)
    check("nobody began an epoch" in refused.stderr, "there is none any more: " + refused.stderr)
    check("The audit is as it was written" in flow.rigcal("audit", "verify").stdout, "each word about a sensor is held by the audit")


def main():
    with Flow() as flow:
        an_exchanged_part(flow)
        a_rig_model(flow)
        an_epoch_by_hand(flow)
    print("models: good")


main()
