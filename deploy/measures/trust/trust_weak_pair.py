"""Two lidars at the sides of a car in a tunnel, which looks alike all along, and good measurements of both from the roof. The car rocks between the two
scans. What such a pair says must not move a sensor that the better edges hold; where these are older it may be that one was moved since, and the robot is not
OK. Clouds are drawn here, by rays against the tunnel."""
import json
import math
import pathlib
import random

from ..measure import at_least, at_most, equal
from ..rotations import composed, inverse, of_rpy, of_vector, turned
from ..server import ANSWERED, Server

# T_top_sensor: m, and roll, pitch, yaw in degrees.
TRUE = {"left": ((0.02, 0.58, -0.42), (-0.6, 0.8, 30.7)), "right": ((-0.03, -0.56, -0.43), (-0.5, 0.7, -29.4))}
NOMINAL = {"left": ((0.01, 0.59, -0.41), (0, 0, 30)), "right": ((-0.02, -0.55, -0.44), (0, 0, -30))}
SECTOR_DEG = {"left": (-45, 200), "right": (-200, 45)}  # of the car, in which each sees
BEAMS, STEPS, HIGHEST_DEG, RANGE_NOISE_M, RANGE_MAX_M = 32, 900, 30.0, 0.02, 40.0
ROCKED_DEG = (0.5, 0.3, 0)  # the car while the right one scanned, against the left one's scan
GIVEN_SIGMA_M, GIVEN_SIGMA_RAD = 0.003, 0.0005  # of the edges from the roof


def quaternion(rpy_deg):
    r = of_rpy([math.radians(a) for a in rpy_deg])
    w = math.sqrt(max(1 + r[0][0] + r[1][1] + r[2][2], 1e-12)) / 2
    q = [(r[2][1] - r[1][2]) / (4 * w), (r[0][2] - r[2][0]) / (4 * w), (r[1][0] - r[0][1]) / (4 * w), w]
    norm = math.sqrt(sum(x * x for x in q))
    return [x / norm for x in q]


def tunnel(chance):
    """Boxes (low, high): floor, ceiling and walls, none of which changes along the road."""
    left, right, floor, ceiling = chance.uniform(4, 6), -chance.uniform(4, 6), -chance.uniform(1.8, 2.2), chance.uniform(3, 4)
    return [((-99, -9, floor - 1), (99, 9, floor)), ((-99, -9, ceiling), (99, 9, ceiling + 1)),
            ((-99, left, -9), (99, left + 1, 9)), ((-99, right - 1, -9), (99, right, 9))]


def to_box(origin, ray, box):
    near, far = 0.0, RANGE_MAX_M
    for at, along, low, high in zip(origin, ray, *box):
        if abs(along) < 1e-9:
            if not low <= at <= high:
                return RANGE_MAX_M
            continue
        first, last = sorted(((low - at) / along, (high - at) / along))
        near, far = max(near, first), min(far, last)
        if near > far:
            return RANGE_MAX_M
    return near if near > 0 else RANGE_MAX_M


def cloud(sensor, boxes, chance):
    """Points in the sensor's own frame."""
    rocked = (0, 0, 0), quaternion(ROCKED_DEG if sensor == "right" else (0, 0, 0))
    car = TRUE[sensor][0], quaternion(TRUE[sensor][1])
    place, turn = composed(rocked, car)
    low, high = SECTOR_DEG[sensor]
    points = []
    for beam in range(BEAMS):
        height = math.radians(HIGHEST_DEG * (2 * beam / (BEAMS - 1) - 1))
        for step in range(STEPS):
            angle = 2 * math.pi * (step + chance.random()) / STEPS
            own = (math.cos(height) * math.cos(angle), math.cos(height) * math.sin(angle), math.sin(height))
            along = turned(car[1], own)
            if not any(low <= math.degrees(math.atan2(along[1], along[0])) + turn_deg <= high for turn_deg in (-360, 0, 360)):
                continue
            far = min(to_box(place, turned(turn, own), box) for box in boxes) + chance.gauss(0, RANGE_NOISE_M)
            if far < RANGE_MAX_M - 1:
                points.append([far * x for x in own])
    return points


def write_session(folder, seed):
    chance = random.Random(seed)
    boxes = tunnel(chance)
    folder.mkdir(parents=True)
    text = "format: 1\nrobot: car\ncaptured_at: 2026-01-01T00:00:00Z\nreference: top\nsensors:\n  top: {type: lidar}\n"
    for sensor, (p_m, rpy_deg) in NOMINAL.items():
        text += "  %s:\n    type: lidar\n    range_bias_sigma_m: 0.005\n    T_ref_nominal: {p_m: %s, q_xyzw: %s}\n" % (
            sensor, json.dumps(p_m), json.dumps(quaternion(rpy_deg)))
        points = cloud(sensor, boxes, chance)
        (folder / sensor).mkdir()
        (folder / sensor / "01.pcd").write_text(
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n" % (
                len(points), len(points)) + "".join("%.4f %.4f %.4f\n" % tuple(point) for point in points))
    (folder / "session.yaml").write_text(text + "skip_pairs: [[top, left], [top, right]]\n")


OLDER = "2025-12-01T00:00:00Z"  # than the session


def write_edges(path, seed, dated=None):
    """From the roof to either side, as sure as they say; measured when they are pushed, or then."""
    chance, edges = random.Random(1000 + seed), []
    for sensor, (p_m, rpy_deg) in TRUE.items():
        off = [chance.gauss(0, GIVEN_SIGMA_M) for _ in range(3)], of_vector([chance.gauss(0, GIVEN_SIGMA_RAD) for _ in range(3)])
        p, q = composed((p_m, quaternion(rpy_deg)), off)
        covariance = [[(GIVEN_SIGMA_M if row < 3 else GIVEN_SIGMA_RAD) ** 2 if row == column else 0 for column in range(6)] for row in range(6)]
        edges.append({"frame_a": "top", "frame_b": sensor, "T_a_b": {"p_m": p, "q_xyzw": q}, "covariance": covariance, "method": "given",
                      **({"measured_at": dated} if dated else {})})
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return {edge["frame_b"]: edge["T_a_b"] for edge in edges}


def judged(context, folder, seed, dated=None):
    """Whether the pair was calibrated, by how many of the given sigmas it moved a sensor, the verdict, and whether somebody says that it counts for nothing."""
    session, edges = folder / "visit", folder / "edges.json"
    write_session(session, seed)
    given = write_edges(edges, seed, dated)
    with Server(context, folder / "data") as server:
        for pushed in (server.rigcal("push-edges", edges, "--robot", "car", "--json"), server.rigcal("push", session, "--json", timeout=600)):
            if pushed.returncode not in ANSWERED:
                raise RuntimeError("rigcal %s: exit %d: %s" % (pushed.args[1], pushed.returncode, pushed.stderr.strip()[-300:]))
        document = json.loads(server.rigcal("show", "car", "--json").stdout)["document"]
        told = server.rigcal("show", "car").stdout
    pairs = [edge for edge in document["edges"] if edge["method"] == "lidar_lidar" and edge["state"] == "good"]
    moved = max(sigmas_apart(one["T_ref_sensor"], given[one["id"]]) for one in document["sensors"] if one["id"] in given)
    return {"good": len(pairs) == 1, "moved": moved, "level": document["verdict"]["level"], "said": "left - right takes no part" in told}


def sigmas_apart(pose, given):
    _, q = composed(inverse((given["p_m"], given["q_xyzw"])), (pose["p_m"], pose["q_xyzw"]))
    angle = 2 * math.asin(min(1.0, math.hypot(*q[:3])))
    return max(math.dist(pose["p_m"], given["p_m"]) / GIVEN_SIGMA_M, angle / GIVEN_SIGMA_RAD)


def run(context):
    seeds = range(1, 11 if context.full else 5)
    with context.folder() as name:
        results, newer = [], []
        for seed in seeds:
            for what, dated, into in (("same-time", None, results), ("older-edges", OLDER, newer)):
                folder = pathlib.Path(name) / ("%d-%s" % (seed, what))
                folder.mkdir()
                into.append(judged(context, folder, seed, dated))
    weak = [one for one in results if one["good"]]
    yield at_least("weak_pair_calibrated_of_%d" % len(results), len(weak), len(results) // 2)
    yield at_most("weak_pair_moved_a_sensor_in_sigmas", max(one["moved"] for one in weak), 0.01)
    yield equal("weak_pair_robot_failed", sum(one["level"] == "fail" for one in weak), 0)
    yield equal("weak_pair_said_to_take_no_part", sum(one["said"] for one in weak), len(weak))
    yield equal("weak_pair_newer_than_better_edges_ok_to_drive", sum(one["good"] and one["level"] in ("pass", "warn") for one in newer), 0)
