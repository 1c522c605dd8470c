#!/usr/bin/env python3
"""Makes a session folder (docs/session-format.md) of a recording of robot_cal_tools: a ChArUco board on a robot's wrist
before a camera that stands still.

extract_robot_cal_tools.py SOURCE OUT [--lens given|estimated]

SOURCE has cal_data.yaml, target.yaml, camera_intr_calibrated.yaml, images/ and poses/ (base_to_wrist). OUT gets session.yaml,
camera/<number>.png and arm/poses.csv. A folder that is there is replaced file by file.
"""
import argparse
import pathlib
import re
import shutil

DICTIONARIES = {8: "DICT_6X6_50", 9: "DICT_6X6_100", 10: "DICT_6X6_250", 11: "DICT_6X6_1000"}  # OpenCV's numbers
HEADING = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n"
SESSION = """format: 1
robot: {robot}
captured_at: 2018-01-01T00:00:00Z
reference: arm
targets:
  wrist:
    type: charuco
    squares: [{cols}, {rows}]
    square_size_m: {square}
    marker_size_m: {marker}
    dictionary: {dictionary}
    mounted_on: arm
sensors:
  arm: {{type: tracker}}
  camera:
    type: camera
    sees: wrist
{lens}"""


def numbers(path):
    """{name: value} of the lines "name: value" whose value is a number."""
    return {name: float(value) for name, value in
            re.findall(r"^\s*(\w+):\s*(-?[0-9.]+(?:e-?[0-9]+)?)", path.read_text(encoding="utf-8"), re.M | re.I)}


def captures(source):
    """(number, image, pose) in the order of the numbers."""
    text = (source / "cal_data.yaml").read_text(encoding="utf-8")
    found = [dict(re.findall(r"(image|pose): (\S+)", item)) for item in re.split(r"^- ", text, flags=re.M)[1:]]
    return sorted((int(pathlib.PurePath(one["image"]).stem), source / one["image"], source / one["pose"]) for one in found)


def make(source, out, lens="given", robot="cell"):
    """`lens`: of the session's camera, held as given or estimated from the pictures."""
    source, out = pathlib.Path(source), pathlib.Path(out)
    target, camera = numbers(source / "target.yaml"), numbers(source / "camera_intr_calibrated.yaml")
    (out / "camera").mkdir(parents=True, exist_ok=True)
    (out / "arm").mkdir(exist_ok=True)
    given = "    intrinsics: {fx_px: %r, fy_px: %r, cx_px: %r, cy_px: %r}\n" % tuple(
        camera[name] for name in ("fx", "fy", "cx", "cy"))
    (out / "session.yaml").write_text(SESSION.format(
        robot=robot, cols=int(target["cols"]), rows=int(target["rows"]), square=target["chessboard_dim"],
        marker=target["aruco_marker_dim"], dictionary=DICTIONARIES[int(target["dictionary"])],
        lens=given if lens == "given" else ""), encoding="utf-8")
    rows = HEADING
    for number, image, pose in captures(source):
        told = numbers(pose)
        rows += "%02d,%d,%s\n" % (number, number, ",".join(repr(told[key]) for key in ("x", "y", "z", "qx", "qy", "qz", "qw")))
        shutil.copyfile(image, out / "camera" / ("%02d.png" % number))
    (out / "arm" / "poses.csv").write_text(rows, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("out")
    parser.add_argument("--lens", choices=("given", "estimated"), default="given")
    options = parser.parse_args()
    make(options.source, options.out, options.lens)


if __name__ == "__main__":
    main()
