"""Visits to the virtual MARS Mapper that carry one lidar and the tracker's body only, and how far their edge is from the
truth."""
import json
import re
import subprocess

LIDARS = ("lidar_horizontal", "lidar_vertical")


def rig_of(context, folder, lidar, robot):
    """The MARS Mapper with this lidar and the body alone: one pair, which the whole rig leaves out."""
    rig = subprocess.run([str(context.bin / "rigcal"), "simulate", "--print-rig", "mars-mapper"], capture_output=True,
                         text=True, check=True).stdout
    rig = re.sub(r"(?m)^  \w+:\n    \{type: camera.*\n(     .*\n)+", "", rig)
    rig = re.sub(r"(?m)^  (?!%s)\w+: \{type: lidar.*\n" % lidar, "", rig)
    rig = re.sub(r"(?m)^reference: \w+", "reference: " + lidar, rig)
    rig = re.sub(r"(?m)^robot: .*", "robot: " + robot, rig)
    path = folder / (robot + ".yaml")
    path.write_text(rig[:rig.index("skip_pairs:")])
    return path


def simulate(context, folder, lidar, seed, *options):
    """The visit's folder, whose name is the robot's, and the Cramer-Rao sigmas x y z rx ry rz of the body in the lidar (None:
    unknown)."""
    visit = folder / ("%s-%d" % (lidar, seed))
    done = context.run_json("rigcal", "simulate", rig_of(context, folder, lidar, visit.name), "--out", visit, "--seed", seed, "--json", *options)
    return visit, done["sensors"]["body"]["bound_sigma"]


def edge_of(server, visit):
    edges = json.loads(server.rigcal("show", visit.name, "--whole", "--json").stdout)["document"]["edges"]
    if [edge["method"] for edge in edges] != ["tracker_lidar"]:
        raise RuntimeError("one edge, tracker_lidar: %r" % [edge["method"] for edge in edges])
    return edges[0]


def error_of(server, visit):
    """What `compare` says of the body in the lidar's frame against the truth: e, sigmas and so on."""
    compared = json.loads(server.rigcal("compare", visit.name, "--poses", visit / "truth.yaml", "--json").stdout)
    return next(sensor for sensor in compared["sensors"] if sensor["id"] == "body")
