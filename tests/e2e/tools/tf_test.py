"""A robot's ROS 2 is told its calibration: the bytes, names and QoS that ROS 2 has, who comes late, what is approved meanwhile, what is not."""
import json
import os
import pathlib
import select
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import uuid

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import ROOT, Flow, check  # noqa: E402

ROBOT = "rig"
UNREACHABLE, REFUSED = 3, 4
ROS_DOMAIN = 74
ROS_TAG = "ros-" + uuid.uuid4().hex[:12]
BAG = ROOT.parent / "shared/data/bags/formats/alltypes/alltypes.db3"
# Loopback alone, and a tag, so that no robot nearby is met.
CYCLONE = ("<CycloneDDS><Domain Id='any'><General><Interfaces><NetworkInterface name='lo'/></Interfaces><AllowMulticast>spdp</AllowMulticast>"
           "</General><Discovery><Tag>%s</Tag><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>"
           "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>" % ROS_TAG)


class Cdr:
    """Plain CDR, least byte first: each value at a multiple of its size behind the header."""
    def __init__(self):
        self.body = b""

    def number(self, form, value):
        self.body += b"\0" * (-len(self.body) % struct.calcsize(form)) + struct.pack("<" + form, value)
        return self

    def text(self, value):
        self.number("I", len(value) + 1)
        self.body += value.encode() + b"\0"
        return self


def tf_message(transforms, stamp=(0, 0)):
    """[(parent, child, [x y z], [x y z w])] as the body of a tf2_msgs/TFMessage."""
    cdr = Cdr().number("I", len(transforms))
    for parent, child, p_m, q_xyzw in transforms:
        cdr.number("i", stamp[0]).number("I", stamp[1]).text(parent).text(child)
        for value in [*p_m, *q_xyzw]:
            cdr.number("d", value)
    return cdr.body


def padded(body):
    return body + b"\0" * (-len(body) % 4)


def as_recorded():
    """The layout above is that of what ROS 2 recorded."""
    if not BAG.exists():
        print("no recorded bag: the layout is held against nothing")
        return
    bag = sqlite3.connect("file:%s?mode=ro&immutable=1" % BAG, uri=True)
    recorded = [row[0] for row in bag.execute("select m.data from messages m join topics t on t.id = m.topic_id where t.type = 'tf2_msgs/msg/TFMessage'")]
    check(recorded, "the bag has transforms")
    for message in recorded:
        stamp = struct.unpack_from("<iI", message, 8)
        ours = tf_message([("test_frame", "child_frame", [1, 2, 3], [0, 0, 0, 1])], stamp)
        check(padded(message[4:]) == padded(ours), "a recorded message: %s instead of %s" % (ours.hex(), message.hex()))


class Reader:
    """A program of ROS 2 that reads one topic."""
    def __init__(self, flow, count, seconds=60, topic="rt/tf_static"):
        self.process = subprocess.Popen([flow.context.bin / "ros_reader", str(ROS_DOMAIN), topic, "tf", str(count), str(seconds)],
                                        stdout=subprocess.PIPE, text=True, env={**os.environ, "CYCLONEDDS_URI": CYCLONE})
        check(json.loads(self.process.stdout.readline())["ready"], "the reader is there")

    def next(self):
        line = self.process.stdout.readline()
        check(line, "a message came")
        return json.loads(line)

    def nothing(self):
        return self.process.communicate()[0] == ""

    def close(self):
        self.process.kill()
        self.process.communicate()


def words(*more):
    return ("tf", ROBOT, "--ros-domain", ROS_DOMAIN, "--ros-tag", ROS_TAG, *more)


def start(flow, *more):
    return subprocess.Popen(flow.server.client(*words("--json", *more)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            env=flow.server.environment())


def stop(process):
    process.send_signal(signal.SIGTERM)
    err = process.communicate(timeout=60)[1]
    check(process.returncode == 0, "it ends well: %d %s" % (process.returncode, err))
    return err


def push(flow, b_m):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", b_m), edge("b", "c", 2.0 - b_m), edge("a", "c", 2.0)]}))
    flow.rigcal("push-edges", path, "--robot", ROBOT)


def solved(flow, revision, root="a", frames=None):
    """What is to be published, of the server's own document by `lookup`."""
    transforms = []
    for sensor in sorted({"a", "b", "c"} - {root}):
        told = json.loads(flow.server.rigcal("lookup", ROBOT, root, sensor, "--revision", revision, "--json").stdout)["T_a_b"]
        names = frames or {}
        transforms.append((names.get(root, root), names.get(sensor, sensor), told["p_m"], told["q_xyzw"]))
    return transforms


def decoded(message, count):
    """Of each transform its frames and numbers."""
    body, at, found = message[4:], 4, []
    check(struct.unpack_from("<I", body)[0] == count, "%d transforms: %s" % (count, message.hex()))
    for _ in range(count):
        at += -at % 4 + 8  # the stamp
        names = []
        for _ in range(2):
            at += -at % 4
            size = struct.unpack_from("<I", body, at)[0]
            names.append(body[at + 4:at + 3 + size].decode())
            at += 4 + size
        at += -at % 8
        values = struct.unpack_from("<7d", body, at)
        at += 56
        found.append((names[0], names[1], list(values[:3]), list(values[3:])))
    return found


def expect(told, wanted):
    """The names byte for byte, and numbers that are the server's."""
    check(told["topic"] == "rt/tf_static" and told["type"] == "tf2_msgs::msg::dds_::TFMessage_", "topic and type: %r" % told)
    check(told["reliable"] and told["transient_local"] and told["depth"] == 1, "QoS of tf2_ros's static broadcaster: %r" % told)
    message = bytes.fromhex(told["cdr"])
    check(message[:2] == b"\0\1", "plain CDR, least byte first: " + message[:4].hex())
    found = decoded(message, len(wanted))
    check(padded(tf_message(found)) == padded(message[4:]), "written as ROS 2 writes it, stamp 0: " + message.hex())
    for one, other in zip(sorted(found), sorted(wanted)):
        check(one[:2] == other[:2], "frames %r instead of %r" % (one, other))
        check(max(abs(x - y) for x, y in zip(one[2] + one[3], other[2] + other[3])) < 1e-12, "%r instead of %r" % (one, other))


def once(flow):
    said = flow.rigcal(*words("--once", "--timeout", 2), exit_code=UNREACHABLE).stderr
    check("nobody in ROS domain %d reads /tf_static" % ROS_DOMAIN in said, "nobody is there: " + said)
    reader = Reader(flow, 2)  # it stays until it is closed, as a robot's programs do
    told = json.loads(flow.rigcal(*words("--once", "--json", "--timeout", 30)).stdout)
    check(told["revision"] == 1 and told["standing"] == "in use" and sorted(told["frames"]) == ["b", "c"] and told["topics"] == ["/tf_static"], "told: %r" % told)
    expect(reader.next(), solved(flow, 1))
    reader.close()


def another_root(flow):
    reader = Reader(flow, 2)
    flow.rigcal(*words("--once", "--timeout", 30, "--root", "top_link", "--frame", "b=top_link", "--camera-info"))
    expect(reader.next(), solved(flow, 1, root="b", frames={"b": "top_link"}))
    reader.close()
    said = flow.rigcal(*words("--once", "--root", "nobody"), exit_code=REFUSED).stderr
    check("'nobody' is no sensor" in said, "an unknown root: " + said)


def approved_meanwhile(flow):
    running = start(flow)
    check(json.loads(running.stdout.readline())["revision"] == 1, "the first is published")
    late = Reader(flow, 2)
    expect(late.next(), solved(flow, 1))
    policy = flow.folder / "policy.yaml"
    policy.write_text("approval: person\n")
    flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
    push(flow, 1.0004)
    newest = json.loads(flow.server.rigcal("show", ROBOT, "--json").stdout)
    check(newest["state"] == "candidate" and newest["usable"]["revision"] < newest["revision"], "the new one waits: %r" % newest["state"])
    reader = Reader(flow, 1)
    in_use = newest["usable"]["revision"]
    expect(reader.next(), solved(flow, in_use))
    reader.close()
    flow.rigcal("approve", ROBOT, newest["revision"], "--reason", "checked")
    told = json.loads(running.stdout.readline())
    check(told["revision"] == newest["revision"], "what was approved, and no candidate before: %r" % told)
    last = late.next()
    expect(last, solved(flow, newest["revision"]))
    late.close()
    after = Reader(flow, 1)
    expect(after.next(), solved(flow, newest["revision"]))
    after.close()
    return running, newest["revision"]


def taken_back(flow, running, newest):
    """The server's end takes nothing back; a rejection of all that was approved does."""
    flow.kill_and_restart()
    reader = Reader(flow, 1)
    expect(reader.next(), solved(flow, newest))
    reader.close()
    for row in json.loads(flow.rigcal("history", ROBOT, "--json").stdout)["revisions"]:
        if row["state"] in ("approved", "superseded"):
            flow.rigcal("reject", ROBOT, row["revision"], "--reason", "the mast was bent")
    for line in running.stderr:
        if "Programs that start now are told no transforms" in line:
            break
    check(Reader(flow, 1, seconds=2).nothing(), "who comes now is told nothing")
    stop(running)
    said = flow.rigcal(*words("--once"), exit_code=REFUSED).stderr
    check("is not approved" in said and "--even-if-not-approved" not in said, "nothing is in use: " + said)


def another_store(flow):
    """The server's store is lost and the robot pushed again: the same number, other poses."""
    running = start(flow)
    first = json.loads(running.stdout.readline())["revision"]
    flow.server.kill()
    shutil.rmtree(flow.folder / "store")
    flow.server.start()
    flow.address = flow.ready()
    push(flow, 1.3)
    told, _, _ = select.select([running.stdout], [], [], 60)
    check(told, "what is in use now is told")
    check(json.loads(running.stdout.readline())["revision"] == first, "under the number of before")
    reader = Reader(flow, 1)
    expect(reader.next(), solved(flow, first))
    reader.close()
    stop(running)


def main():
    as_recorded()
    with Flow() as flow:
        push(flow, 1.0)
        once(flow)
        another_root(flow)
        taken_back(flow, *approved_meanwhile(flow))
    with Flow() as flow:
        push(flow, 1.0)
        another_store(flow)
    print("tf: good")


main()
