"""Clouds of 5 floats a point: refused until session.yaml says so, then worth as much as the same clouds as PCD."""
import json
import pathlib
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from lidar_rig import rig_of  # noqa: E402

REFUSED = 4  # exit code


def points_of(pcd):
    """x y z intensity ring of each point of a simulated cloud."""
    head, body = pcd.split(b"DATA binary\n", 1)
    check(b"FIELDS x y z intensity ring\nSIZE 4 4 4 4 2\n" in head, "the simulator's PCD: %r" % head)
    return list(struct.iter_unpack("<4fH", body))


def pack_anew(visit):
    """Each PCD as a .bin of x y z intensity ring."""
    for path in sorted(visit.glob("*/*.pcd")):
        points = points_of(path.read_bytes())
        points = points[:len(points) // 4 * 4]  # so that the size alone tells nothing
        path.with_suffix(".bin").write_bytes(b"".join(struct.pack("<5f", *point) for point in points))
        path.unlink()


def edge_of(flow, robot):
    edge, = json.loads(flow.rigcal("show", robot, "--json").stdout)["document"]["edges"]
    check(edge["state"] == "good", "an edge: %r" % edge)
    return edge


def main():
    with Flow() as flow:
        visit = flow.folder / "visit"
        flow.rigcal("simulate", rig_of(flow), "--out", visit, "--seed", 1, "--captures", 8)
        flow.rigcal("push", visit)
        plain = edge_of(flow, "pair")

        header = visit / "session.yaml"
        text = header.read_text().replace("robot: pair", "robot: five")
        header.write_text(text)
        pack_anew(visit)
        said = flow.rigcal("push", visit, exit_code=REFUSED).stderr
        check('file "lidar_' in said and "fields: [x, y, z, intensity, ring]" in said, "the line to write is told: " + said)
        check("sensor 'lidar_" in said, "the sensor is named: " + said)

        header.write_text(text.replace("type: lidar\n", "type: lidar\n    fields: [x, y, z, intensity, ring]\n"))
        check("fields" in header.read_text(), "session.yaml names them: " + header.read_text())
        flow.rigcal("push", visit)
        five = edge_of(flow, "five")
        off_m = max(abs(p - q) for p, q in zip(five["T_a_b"]["p_m"], plain["T_a_b"]["p_m"]))
        check(off_m < 1e-4, "the same pose but for 3 points of a cloud: %r, %r" % (five["T_a_b"], plain["T_a_b"]))
    print("bin_layout: good")


main()
