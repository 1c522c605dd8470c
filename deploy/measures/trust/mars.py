"""The virtual MARS Mapper at full size, from captures to the published report, against its truth."""
import json
import math
import pathlib
import re
import time

from ..measure import at_least, at_most, equal
from ..server import ANSWERED, Server

LIDARS = ("lidar_vertical", "lidar_horizontal")


def rms(values):
    return math.sqrt(sum(values) / max(1, len(values)))


def bounds_of(truth):
    """Cramer-Rao sigmas x y z rx ry rz by sensor."""
    found, sensor = {}, None
    for line in truth.read_text().splitlines():
        if match := re.match(r"  (\w+):", line):
            sensor = match.group(1)
        if match := re.match(r"    bound_sigma: \[([^\]]*)\]", line):
            found[sensor] = [float(value) for value in match.group(1).split(",")]
    return found


def refined_in_s(log):
    """What the joint refinement added between the last pair and the report."""
    [seconds] = re.findall(r"refined in ([0-9.]+) s", log.read_text())
    return float(seconds)


def one_visit(context, folder, seed):
    """What `rigcal compare` says of one simulated visit, good edges, seconds from push to report, and those of the refinement."""
    session = folder / ("visit-%d" % seed)
    context.run_json("rigcal", "simulate", "mars-mapper", "--out", session, "--seed", seed, "--json")
    with Server(context, folder / ("data-%d" % seed)) as server:
        began = time.monotonic()
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        took_s = time.monotonic() - began
        edges = json.loads(server.rigcal("edges", "mars-mapper", "--json").stdout)["edges"]
        compared = json.loads(server.rigcal("compare", "mars-mapper", "--poses", session / "truth.yaml", "--json").stdout)
    if pushed.returncode not in ANSWERED:
        raise RuntimeError("rigcal push: exit %d: %s" % (pushed.returncode, pushed.stderr.strip()[-300:]))
    refined_s = refined_in_s(folder / ("data-%d.log" % seed))
    return compared, bounds_of(session / "truth.yaml"), sum(edge["state"] == "good" for edge in edges), took_s, refined_s


def run(context):
    squares = {"%s_%s" % (what, part): [] for what in ("camera", "lidar", "camera_bound", "lidar_bound") for part in ("m", "rad")}
    good, worst_sigmas, slowest_s, refined_s = [], 0.0, 0.0, 0.0
    with context.folder() as name:
        for seed in range(1, 11 if context.full else 4):
            compared, bounds, edges, took_s, refinement_s = one_visit(context, pathlib.Path(name), seed)
            good.append(edges)
            slowest_s, refined_s = max(slowest_s, took_s), max(refined_s, refinement_s)
            worst_sigmas = max(worst_sigmas, compared["worst_sigmas"])
            for sensor in compared["sensors"]:
                if sensor["id"] == "body":
                    continue
                kind = "lidar" if sensor["id"] in LIDARS else "camera"
                squares[kind + "_m"].append(sum(v * v for v in sensor["e"][:3]))
                squares[kind + "_rad"].append(sum(v * v for v in sensor["e"][3:]))
                squares[kind + "_bound_m"].append(sum(v * v for v in bounds[sensor["id"]][:3]))
                squares[kind + "_bound_rad"].append(sum(v * v for v in bounds[sensor["id"]][3:]))
    yield at_least("good_edges_of_59", min(good), 59)
    yield at_most("cameras_rms", 1e3 * rms(squares["camera_m"]), 0.6, "mm")
    yield at_most("cameras_rms_turn", math.degrees(rms(squares["camera_rad"])), 0.012, "deg")
    yield at_most("lidars_rms", 1e3 * rms(squares["lidar_m"]), 1.2, "mm")
    yield at_most("lidars_rms_turn", math.degrees(rms(squares["lidar_rad"])), 0.05, "deg")
    yield at_most("worst_error_in_sigmas", worst_sigmas, 4.0)
    yield at_most("push_to_report", slowest_s, 60.0, "s")
    yield at_most("of_which_joint_refinement", refined_s, 2.0, "s")
    # Each kind against its own bound: that of the lidars is six times that of the cameras, and would hide it.
    for kind in ("camera", "lidar"):
        for part, unit in (("m", "translation"), ("rad", "rotation")):
            ratio = rms(squares["%s_%s" % (kind, part)]) / rms(squares["%s_bound_%s" % (kind, part)])
            yield at_most("%ss_rms_over_cramer_rao_%s" % (kind, unit), ratio, 1.5)
    yield equal("seeds", len(good), 10 if context.full else 3)
