"""A virtual robot cell, two cameras beside a robot with a board on its flange: pushed as a folder, calibrated by the service,
against its truth; and the same folder without `mounted_on`, which is refused with the word that is missing."""
import json
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

ROBOT = "cell-01"


def document_of(flow, robot):
    return json.loads(flow.server.rigcal("show", robot, "--whole", "--json").stdout)["document"]


def simulate(flow):
    visit = flow.folder / "cell"
    flow.rigcal("simulate", "eye-to-hand-cell", "--out", visit, "--captures", "24", "--scale", "0.5", "--seed", "3")
    return visit


def check_edges(edges):
    pairs = sorted((edge["method"], edge["frame_a"], edge["frame_b"]) for edge in edges)
    check(pairs == [("eye_to_hand", "front", "arm"), ("eye_to_hand", "side", "arm"), ("stereo", "front", "side")], "pairs: %r" % pairs)
    for edge in edges:
        check(edge["state"] == "good" and edge["rank"] == 6, "%s: %r" % (edge["method"], edge["diagnoses"]))
    for edge in edges:
        if edge["method"] == "eye_to_hand":
            worst_px = max(capture["rms"] for capture in edge["captures"] if capture["used"])
            check(0 < worst_px < 3, "corners within pixels of where the robot has them: %.2f" % worst_px)
            off_m = sum(edge["figures"]["flange_board_%s_m" % axis] ** 2 for axis in "xyz") ** 0.5
            check(off_m < 0.5, "where the board sits on the flange is told: %.3f m" % off_m)


def check_against_truth(flow, visit):
    compared = json.loads(flow.server.rigcal("compare", ROBOT, "--poses", visit / "truth.yaml", "--json").stdout)["sensors"]
    errors = {sensor["id"]: sensor["e"] for sensor in compared}
    for sensor in document_of(flow, ROBOT)["sensors"]:
        if sensor["id"] == "front":
            continue
        worst = max(abs(e) / s for e, s in zip(errors[sensor["id"]], sensor["sigma_m"] + sensor["sigma_rad"]))
        check(worst < 4.5, "%s is %.2f of its sigmas off" % (sensor["id"], worst))
        check(max(sensor["sigma_m"]) < 0.002, "%s is known to millimetres: %r" % (sensor["id"], sensor["sigma_m"]))
        print("%s: %.2f of its sigmas at worst" % (sensor["id"], worst))


def check_wrong_word(flow, visit):
    wrong = flow.folder / "wrong"
    shutil.copytree(visit, wrong)
    text = (wrong / "session.yaml").read_text()
    check(", mounted_on: arm" in text, "the session says what carries the board")
    (wrong / "session.yaml").write_text(text.replace(", mounted_on: arm", "").replace(ROBOT, "cell-02"))
    flow.server.rigcal("push", wrong, "--new-robot")
    failed = [edge for edge in document_of(flow, "cell-02")["edges"] if edge["method"] == "tracker_camera"]
    check(len(failed) == 2, "two pairs are read as a robot before a board that stands still")
    for edge in failed:
        first = edge["diagnoses"][0]
        check(edge["state"] == "failed" and first["code"] == "board_on_flange", "refused: %r" % edge["diagnoses"])
        check("mounted_on: arm" in first["cure"], "the cure names the word: " + first["cure"])


def main():
    with Flow() as flow:
        visit = simulate(flow)
        flow.rigcal("push", visit)
        check_edges(document_of(flow, ROBOT)["edges"])
        check_against_truth(flow, visit)
        check_wrong_word(flow, visit)


if __name__ == "__main__":
    main()
