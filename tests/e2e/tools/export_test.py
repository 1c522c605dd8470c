"""A calibration leaves for other programs and comes back: URDF fresh and patched, static transforms, another root, what is refused; a file
against a robot; edges from a file."""
import json
import math
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402

ROBOT = "rig"
FAIL, REFUSED, UNKNOWN = 1, 4, 6

EXISTING = """<?xml version="1.0"?>
<!-- by hand; keep -->
<robot name="cart">
  <link name="base"/><link name="a"/><link name="b_link"/><link name="c"/>
  <joint name="base_a" type="fixed"><parent link="base"/><child link="a"/><origin xyz="0.5 0 0.25" rpy="0 0 0"/></joint>
  <joint name="a_b"    type="fixed"><parent link="a"/><child link="b_link"/><origin   rpy='0 0 0'   xyz='1.25 0 0'/></joint>
  <joint name="b_c" type="fixed"><parent link="b_link"/><child link="c"/><origin xyz="1 0 0"/></joint>
</robot>
"""


def push(flow, b_m, exit_code=None, c_m=2.0):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", b_m), edge("b", "c", c_m - b_m), edge("a", "c", c_m)]}))
    flow.rigcal("push-edges", path, "--robot", ROBOT, exit_code=exit_code)


def export(flow, *arguments, exit_code=0):
    return flow.rigcal("export", ROBOT, *arguments, exit_code=exit_code)


def joints(path):
    """Of each joint its parent, child and xyz."""
    found = {}
    for joint in xml.parse(path).getroot().findall("joint"):
        xyz = [float(x) for x in joint.find("origin").get("xyz", "0 0 0").split()]
        found[joint.find("child").get("link")] = (joint.find("parent").get("link"), xyz)
    return found


def near(values, wanted, what):
    check(max(abs(x - y) for x, y in zip(values, wanted)) < 1e-9, "%s: %r instead of %r" % (what, values, wanted))


def fresh(flow):
    done = json.loads(export(flow, "--out", flow.folder / "rig.urdf", "--json").stdout)
    check(done["format"] == "urdf" and done["revision"] == 1 and done["standing"] == "in use" and done["root"] == "a", "export: %r" % done)
    found = joints(flow.folder / "rig.urdf")
    near(found["b"][1], [1, 0, 0], "b in a")
    near(found["c"][1], [2, 0, 0], "c in a")
    export(flow, "--out", flow.folder / "from_b.urdf", "--root", "b")
    found = joints(flow.folder / "from_b.urdf")
    check(found["a"][0] == "b", "the root is b: %r" % found)
    near(found["a"][1], [-1, 0, 0], "a in b")
    near(found["c"][1], [1, 0, 0], "c in b")
    check("'nobody' is no sensor" in export(flow, "--out", flow.folder / "x.urdf", "--root", "nobody", exit_code=REFUSED).stderr, "an unknown root")


def covariance_in_another_root(flow):
    """As `lookup` tells it: what the solution knows of both sensors together, and not the sum of both."""
    export(flow, "--format", "json", "--out", flow.folder / "rig.json", "--root", "b")
    sensors = {one["id"]: one for one in json.loads((flow.folder / "rig.json").read_text())["sensors"]}
    for name in ("a", "c"):
        told = json.loads(flow.rigcal("lookup", ROBOT, "b", name, "--json").stdout)
        for row, wanted in zip(sensors[name]["covariance"], told["covariance"]):
            check(max(abs(x - y) for x, y in zip(row, wanted)) < 1e-15, "covariance of %s in b" % name)
        near(sensors[name]["T_root_sensor"]["p_m"], told["T_a_b"]["p_m"], name + " in b")


def patched(flow):
    existing, new = flow.folder / "cart.urdf", flow.folder / "new.urdf"
    existing.write_text(EXISTING)
    said = export(flow, "--out", new, "--into", existing, "--frame", "b=b_link")
    check("@@ line 6, joint a_b: b_link moved 250.000 mm, turned 0.0000 deg" in said.stdout, "the change is shown: " + said.stdout)
    check("-  <origin   rpy='0 0 0'   xyz='1.25 0 0'/>" in said.stdout, "as it was: " + said.stdout)
    text = new.read_text()
    near(joints(new)["b_link"][1], [1, 0, 0], "b in a")
    check(re.sub("xyz='[^']*'|rpy='[^']*'", "", text) == re.sub("xyz='[^']*'|rpy='[^']*'", "", EXISTING), "nothing else changed: " + text)
    check(existing.read_text() == EXISTING, "the file that was given stays")
    again = export(flow, "--out", new, "--into", new, "--frame", "b=b_link")
    check("nothing changes" in again.stdout and new.read_text() == text, "patched twice is patched once")
    existing.write_text('<robot xmlns:xacro="x"><xacro:property name="a"/></robot>')
    check("`xacro " in export(flow, "--out", new, "--into", existing, exit_code=REFUSED).stderr, "a xacro file is refused")


def formats(flow):
    for name, ending in (("tf2", "yaml"), ("tf2_launch", "xml"), ("autoware", "yaml"), ("opencv", "yaml"), ("csv", "csv")):
        export(flow, "--format", name, "--out", flow.folder / ("rig_%s.%s" % (name, ending)))
        check("revision 1 (in use)" in (flow.folder / ("rig_%s.%s" % (name, ending))).read_text(), name + " says what it is")
    for name in ("kalibr", "camera_info", "colmap", "basalt", "kitti"):
        said = export(flow, "--format", name, "--out", flow.folder / "none", exit_code=REFUSED).stderr
        check("no camera of rig has intrinsics" in said, "%s without cameras: %s" % (name, said))
    check("there is no format 'urfd'" in export(flow, "--format", "urfd", "--out", flow.folder / "x", exit_code=REFUSED).stderr, "a misspelt format")


def approval(flow):
    policy = flow.folder / "policy.yaml"
    policy.write_text("approval: person\n")
    flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
    push(flow, 1.0001)
    newest = json.loads(flow.rigcal("show", ROBOT, "--json").stdout)
    check(newest["state"] == "candidate", "the second waits: %r" % newest["state"])
    done = json.loads(export(flow, "--out", flow.folder / "rig.csv", "--json").stdout)
    check(done["revision"] == newest["usable"]["revision"], "what is in use leaves: %r" % done)
    number = newest["revision"]
    refused = export(flow, "--out", flow.folder / "no.csv", "--revision", number, exit_code=REFUSED).stderr
    check("is not approved: it is candidate" in refused and "`rigcal approve rig %d --reason TEXT`" % number in refused, "a candidate: " + refused)
    check(not (flow.folder / "no.csv").exists(), "nothing was written")
    forced = export(flow, "--out", flow.folder / "forced.csv", "--revision", number, "--even-if-not-approved")
    check("not approved" in forced.stderr and "(candidate, not approved)" in (flow.folder / "forced.csv").read_text(), "forced: " + forced.stderr)


def compared(flow):
    """The tf2 file is of revision 1; b of it is moved by 5 mm along x."""
    path = flow.folder / "moved.yaml"
    text = (flow.folder / "rig_tf2.yaml").read_text()
    path.write_text(re.sub(r"(child_frame_id: \"b\".*?translation: \{x: )[^,]*", r"\g<1>0.995", text, count=1, flags=re.DOTALL))
    told = json.loads(flow.rigcal("diff", path, ROBOT, "--revision", 1, "--json").stdout)
    e = {one["id"]: one["e"] for one in told["sensors"]}
    near(e["b"], [0.005, 0, 0, 0, 0, 0], "from where the file has b to where it is")
    near(e["c"], [0] * 6, "c")
    check("5.000" in flow.rigcal("diff", path, ROBOT, "--revision", 1).stdout, "in mm for people")
    flow.rigcal("diff", path, ROBOT, "--revision", 1, "--sigmas-max", 3, exit_code=FAIL)


def half_compared(flow):
    """A file that lacks c, and one whose c hangs on a joint that moves, agree with nothing that is said of c."""
    path = flow.folder / "half.urdf"
    text = (flow.folder / "rig.urdf").read_text()
    path.write_text(re.sub(r'<link name="c"/>|<joint name="c_joint".*?</joint>', "", text, flags=re.DOTALL))
    check(set(joints(path)) == {"b"}, "c is gone: " + path.read_text())
    told = flow.rigcal("diff", path, ROBOT, "--revision", 1, exit_code=UNKNOWN).stdout
    check("not compared: c is not in %s. Name" % path in told, "who was not compared: " + told)
    told = json.loads(flow.rigcal("diff", path, ROBOT, "--revision", 1, "--sigmas-max", 3, "--json", exit_code=UNKNOWN).stdout)
    check(told["missing"] == ["c"] and "c is not in" in told["not_compared"] and told["other_frames"] == 0, "as JSON: %r" % told)
    told = json.loads(flow.rigcal("diff", path, ROBOT, "--revision", 1, "--without", "c", "--json", exit_code=0).stdout)
    check(told["without"] == ["c"] and "missing" not in told, "c need not be there: %r" % told)
    said = flow.rigcal("diff", path, ROBOT, "--without", "d", exit_code=REFUSED).stderr
    check("'d', which --without names, is no sensor of rig" in said, "a sensor that there is not: " + said)
    path.write_text(text.replace('"c_joint" type="fixed"', '"c_joint" type="continuous"').replace(
        "</robot>", '<link name="bumper"/><joint name="on_a" type="fixed"><parent link="a"/><child link="bumper"/></joint></robot>'))
    told = flow.rigcal("diff", path, ROBOT, "--revision", 1, exit_code=UNKNOWN).stdout
    check("but nothing fixed ties it to a" in told, "a joint that moves: " + told)
    check("that are no sensors: 1" in told, "other frames are counted: " + told)


def assumed(flow):
    flow.server.rigcal("push-edges", flow.folder / "rig_tf2.yaml", "--robot", "drawn", "--assumed-sigma", "5,0.5", "--new-robot")
    rows = json.loads(flow.rigcal("edges", "drawn", "--json").stdout)["edges"]
    check(len(rows) == 2 and {row["source"] for row in rows} == {"assumed"}, "assumed edges: %r" % rows)
    near(rows[0]["sigma_m"], [0.005] * 3, "sigma in m")
    near(rows[0]["sigma_rad"], [math.radians(0.5)] * 3, "sigma in rad")


def main():
    with Flow() as flow:
        push(flow, 1.0)
        for part in (fresh, covariance_in_another_root, patched, formats, compared, half_compared, assumed, approval):
            part(flow)
    print("export: good")


main()
