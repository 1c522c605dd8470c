"""A camera on a robot's flange, and two streams of poses: pushed as folders, calibrated by the service."""
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, skip_without  # noqa: E402
from measures.pairs import hand_eye_sessions  # noqa: E402


def edge_of(flow, robot, method):
    edges = json.loads(flow.rigcal("show", robot, "--whole", "--json").stdout)["document"]["edges"]
    check([edge["method"] for edge in edges] == [method], "one edge, %s: %r" % (method, [edge["method"] for edge in edges]))
    check(edges[0]["state"] == "good", "%s: %r" % (method, edges[0]["diagnoses"]))
    return edges[0]


def main():
    with Flow() as flow:
        robot_data, stream_data = flow.context.data / "handeye_visp_franka", flow.context.data / "handeye_asl"
        skip_without(robot_data)
        skip_without(stream_data)
        hand_eye_sessions.make_visp(robot_data / "data-eye-in-hand", flow.folder / "robot", "franka")
        flow.rigcal("push", flow.folder / "robot")
        edge = edge_of(flow, "franka", "tracker_camera")
        away_m = math.dist(edge["T_a_b"]["p_m"], (0.057715, -0.033925, -0.042277))
        check(away_m < 0.005, "camera on the flange: %.4f m from the author's value" % away_m)
        check(edge["frame_a"] == "flange" and edge["frame_b"] == "camera", "frames in the order of session.yaml")
        again = json.loads(flow.rigcal("push", flow.folder / "robot", "--json").stdout)
        check(again["items"] == 9 and again["held_before"] == again["total"], "pushing again sends nothing")

        hand_eye_sessions.make_streams(hand_eye_sessions.vicon(flow.context.data), flow.folder / "streams", "vicon")
        flow.rigcal("push", flow.folder / "streams")
        streams = edge_of(flow, "vicon", "pose_streams")
        away_m = math.dist(streams["T_a_b"]["p_m"], (0.0724, 0.0459, 0.0262))
        check(away_m < 0.010, "camera on the tracked body: %.4f m from the check" % away_m)
        check(abs(streams["figures"]["clock_offset_s"] - 0.024) < 0.005, "offset of the clocks: %r" % streams["figures"])
    print("hand-eye: good")


main()
