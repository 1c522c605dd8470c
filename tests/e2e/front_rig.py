"""A rig of three cameras before one board: every pair is checked by the two others."""
import re

from flow import check

THIRD = ("  front_top:\n    {type: camera, sees: front, T_body_sensor: {p_m: [0.302, 0.004, 0.151], rpy_deg: [0.2, 1.3, -0.4]},\n"
         "     lens: {fx_px: 1449.1, fy_px: 1449.7, cx_px: 1221.3, cy_px: 1021.2, distortion: [-0.081, 0.072, 0.0001, 0.0002, -0.01]},\n"
         "     intrinsics_sigma: [0.1, 0.1, 0.1, 0.1, 0.0002, 0.0003, 0.00001, 0.00001, 0]}\n")


def front_rig(flow, robot, name, moved_m=0.0):
    """The MARS Mapper's cameras to the front and one more; the second of them moved to the side. Its file."""
    rig = flow.rigcal("simulate", "--print-rig", "mars-mapper").stdout
    head, sensors = rig.split("\nsensors:\n")
    front = re.findall(r"(?m)^  front_\w+:\n(?:    .*\n|     .*\n)+", sensors)
    check(len(front) == 2 and "front_right" in front[1], "the rig has two cameras to the front: %r" % front)
    front[1] = front[1].replace("[0.301, -0.101,", "[0.301, %.3f," % (-0.101 - moved_m))
    path = flow.folder / (name + ".yaml")
    path.write_text(head.replace("robot: mars-mapper", "robot: " + robot) + "\nsensors:\n" + "".join(front) + THIRD)
    return path
