"""A rig of two lidars for simulated visits of the robot `pair`."""
import re

from flow import check


def rig_of(flow):
    """The MARS Mapper's two lidars by themselves."""
    rig = flow.rigcal("simulate", "--print-rig", "mars-mapper").stdout
    lidars = re.findall(r"(?m)^  \w+: \{type: lidar.*\n", rig)
    check(len(lidars) == 2, "the rig has two lidars: %r" % lidars)
    head = re.sub(r"(?m)^reference: \w+", "reference: lidar_vertical", rig.split("\nsensors:\n")[0])
    path = flow.folder / "rig.yaml"
    path.write_text(re.sub(r"(?m)^robot: .*", "robot: pair", head) + "\nsensors:\n" + "".join(lidars))
    return path
