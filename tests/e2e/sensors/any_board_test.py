"""Two cameras before each kind of board that people print, its markers numbered from anywhere, its plate off its pattern, with a lidar
where there is a plate: pushed as folders, calibrated by the service and held against their truth."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

RIG = """format: 1
name: board-rig
robot: %s
reference: left
nominal_sigma_m: 0.01
nominal_sigma_deg: 1
motion: {captures: 24, start_m: [0, 0, 2], position_range_m: [0.2, 0.3, 0.25], yaw_range_deg: 20, tilt_rms_deg: 14}
boards:
  board: {%s, T_world_plate: {p_m: [0, 0, 2], rpy_deg: [4, 3, -8]}}
room: {size_m: [6, 6, 4], patches_per_wall: 8}
camera: {size_px: [800, 600], blur_px: 0.7, noise_grey: 2, vignetting_ratio: 0.3, corner_sigma_px: 0.03}
%ssensors:
  left: {type: camera, sees: board, T_body_sensor: {p_m: [-1.3, 0.12, 0.05], rpy_deg: [0, 3, -4]}, lens: {fx_px: 640, fy_px: 641, cx_px: 401, cy_px: 299, distortion: [-0.1, 0.02, 0, 0, 0]}, intrinsics_sigma: [0.3, 0.3, 0.3, 0.3, 0.0005, 0.0005, 0.00001, 0.00001, 0]}
  right: {type: camera, sees: board, T_body_sensor: {p_m: [-1.3, -0.18, 0], rpy_deg: [0, 2, 5]}, lens: {fx_px: 645, fy_px: 644, cx_px: 398, cy_px: 302, distortion: [-0.09, 0.02, 0, 0, 0]}, intrinsics_sigma: [0.3, 0.3, 0.3, 0.3, 0.0005, 0.0005, 0.00001, 0.00001, 0]}
"""
PLATE = ", plate_size_m: [0.9, 0.62]"
LIDAR = """lidar: {elevations_deg: [%s], firings_per_turn: 1800, range_sigma_m: 0.01, range_min_m: 0.4, range_max_m: 40}
""" % ", ".join("%.2f" % (-20 + 1.25 * i) for i in range(32))
BOARDS = {
    "charuco": "type: charuco, squares: [7, 5], square_size_m: 0.09, marker_size_m: 0.065, dictionary: DICT_5X5_100, first_id: 51" + PLATE,
    "tags": "type: april_grid, tags: [4, 3], tag_size_m: 0.12, spacing_ratio: 0.3, first_id: 60, plate_offset_m: [0.1, -0.04]" + PLATE,
    "circles": "type: circle_grid, circles: [8, 5], spacing_m: 0.09, diameter_m: 0.05" + PLATE,
    "shifted-circles": "type: asymmetric_circle_grid, circles: [4, 7], spacing_m: 0.07, diameter_m: 0.06" + PLATE,
}


def visit_of(flow, robot, board):
    rig = flow.folder / (robot + ".yaml")
    above = "  above: {type: lidar, T_body_sensor: {p_m: [-1.3, 0, 0.25], rpy_deg: [1, 2, -1]}}\n"
    rig.write_text(RIG % (robot, board, LIDAR if "plate_offset_m" in board else "") + (above if "plate_offset_m" in board else ""))
    visit = flow.folder / robot
    flow.rigcal("simulate", rig, "--out", visit, "--intrinsics", "calibrated", "--format", "png", "--seed", "5")
    return visit


def check_pose(flow, robot, visit, name, sigma_max_m):
    compared = json.loads(flow.server.rigcal("compare", robot, "--poses", visit / "truth.yaml", "--json").stdout)["sensors"]
    [error] = [sensor["e"] for sensor in compared if sensor["id"] == name]
    document = json.loads(flow.server.rigcal("show", robot, "--whole", "--json").stdout)["document"]
    [told] = [sensor for sensor in document["sensors"] if sensor["id"] == name]
    worst = max(abs(e) / s for e, s in zip(error, told["sigma_m"] + told["sigma_rad"]))
    print("%s: %s is %.2f of its sigmas off, sigma %.2f mm at most" % (robot, name, worst, 1e3 * max(told["sigma_m"])))
    for edge in document["edges"]:
        check(edge["state"] == "good", "%s: %r" % (robot, edge["diagnoses"]))
    check(worst < 4.5, "%s: %s is %.2f of its sigmas off" % (robot, name, worst))
    check(max(told["sigma_m"]) < sigma_max_m, "%s: %s is known well enough: %r" % (robot, name, told["sigma_m"]))


def main():
    with Flow() as flow:
        for robot, board in BOARDS.items():
            visit = visit_of(flow, robot, board)
            flow.rigcal("push", visit, "--new-robot")
            check_pose(flow, robot, visit, "right", 0.003)
            if "plate_offset_m" in board:
                check_pose(flow, robot, visit, "above", 0.02)


if __name__ == "__main__":
    main()
