"""Two wide cameras of a virtual rig, one of the model eucm and one double_sphere: with given lenses, and with lenses that are estimated,
each pushed as a folder, calibrated by the service and held against its truth; and what leaves for other programs."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

SENSORS = """sensors:
  front: {type: camera, sees: board, T_body_sensor: {p_m: [-0.9, 0.1, 0.05], rpy_deg: [0, 3, -6]}, lens: {model: eucm, fx_px: 300, fy_px: 301, cx_px: 320.5, cy_px: 238, distortion: [0.61, 1.08]}, intrinsics_sigma: [0.3, 0.3, 0.3, 0.3, 0.002, 0.004]}
  left: {type: camera, sees: board, T_body_sensor: {p_m: [-0.85, -0.15, 0], rpy_deg: [0, 0, 9]}, lens: {model: double_sphere, fx_px: 236, fy_px: 235, cx_px: 318, cy_px: 241, distortion: [-0.21, 0.58]}, intrinsics_sigma: [0.3, 0.3, 0.3, 0.3, 0.001, 0.002]}
"""
RIG = """format: 1
name: wide-rig
robot: %s
reference: front
nominal_sigma_m: 0.01
nominal_sigma_deg: 1
motion: {captures: 36, start_m: [0, 0, 2], position_range_m: [0.2, 0.45, 0.3], yaw_range_deg: 28, tilt_rms_deg: 16}
boards:
  board: {inner_corners: [9, 6], square_size_m: 0.06, plate_size_m: [0.66, 0.48], T_world_plate: {p_m: [0, 0, 2], rpy_deg: [4, 3, -8]}}
room: {size_m: [6, 6, 4], patches_per_wall: 8}
camera: {size_px: [640, 480], blur_px: 0.7, noise_grey: 2, vignetting_ratio: 0.3, corner_sigma_px: 0.03}
""" + SENSORS


def visit_of(flow, robot, intrinsics):
    rig = flow.folder / (robot + ".yaml")
    rig.write_text(RIG % robot)
    visit = flow.folder / robot
    flow.rigcal("simulate", rig, "--out", visit, "--intrinsics", intrinsics, "--format", "png", "--seed", "3")
    return visit


def check_pose(flow, robot, visit):
    compared = json.loads(flow.server.rigcal("compare", robot, "--poses", visit / "truth.yaml", "--json").stdout)["sensors"]
    errors = {sensor["id"]: sensor["e"] for sensor in compared}
    document = json.loads(flow.server.rigcal("show", robot, "--whole", "--json").stdout)["document"]
    left = [sensor for sensor in document["sensors"] if sensor["id"] == "left"][0]
    worst = max(abs(e) / s for e, s in zip(errors["left"], left["sigma_m"] + left["sigma_rad"]))
    print("%s: left is %.2f of its sigmas off, sigma %.2f mm at most" % (robot, worst, 1e3 * max(left["sigma_m"])))
    check(worst < 4.5, "%s: left is %.2f of its sigmas off" % (robot, worst))
    check(max(left["sigma_m"]) < 0.003, "%s: left is known to millimetres: %r" % (robot, left["sigma_m"]))
    edge = document["edges"][0]
    check(edge["state"] == "good", "%s: %r" % (robot, edge["diagnoses"]))
    check("alpha_a_ratio" in edge["figures"] and "xi_b_ratio" in edge["figures"], "lenses are told: %r" % edge["figures"])


def exported(flow, robot, name):
    path = flow.folder / (robot + "-" + name)
    done = flow.server.rigcal("export", robot, "--format", name, "--even-if-not-approved", "--out", path)
    return path, done.stdout + done.stderr


def check_exports(flow, robot):
    text = exported(flow, robot, "kalibr")[0].read_text()
    check("camera_model: eucm" in text and "camera_model: ds" in text, "Kalibr has both by name: " + text)
    basalt = json.loads(exported(flow, robot, "basalt")[0].read_text())["value0"]["intrinsics"]
    check([one["camera_type"] for one in basalt] == ["eucm", "ds"], "Basalt too: %r" % basalt)
    check(abs(basalt[0]["intrinsics"]["alpha"] - 0.61) < 0.02, "alpha as it is: %r" % basalt[0])
    check(abs(basalt[1]["intrinsics"]["xi"] + 0.21) < 0.02, "xi as it is: %r" % basalt[1])
    path, said = exported(flow, robot, "camera_info")
    check("double_sphere is a lens that camera_info does not have" in said, "ROS has no name for them: " + said)
    check(not path.exists(), "and nothing is written")


def main():
    with Flow() as flow:
        for robot, intrinsics in (("wide-given", "exact"), ("wide-refined", "calibrated"), ("wide-estimated", "absent")):
            visit = visit_of(flow, robot, intrinsics)
            flow.rigcal("push", visit, "--new-robot")
            check_pose(flow, robot, visit)
        check_exports(flow, "wide-estimated")


if __name__ == "__main__":
    main()
