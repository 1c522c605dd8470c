"""`rigcal record` and `rigcal replay`, two processes over real DDS: a session live is the session of the bag; what is amiss is told; nothing is lost."""
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import uuid

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import ROOT, check  # noqa: E402,F401
from measures.tools.bags import mcap_reader, session_bags, writer  # noqa: E402

GOOD, USAGE, UNREACHABLE, REFUSED, MORE = 0, 2, 3, 4, 5
BIN = pathlib.Path(os.environ["RIGCAL_BIN"])
START_NS, COUNT = 1_700_000_000_000_000_000, 40
RIG = """format: 1
robot: live
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  left: {type: camera, topic: /left, sees: board}
  right: {type: camera, topic: /right, sees: board}
  tool: {type: tracker, topic: /tf, frame: base, child_frame: tool}
"""


class Live:
    """A ROS domain of this test alone, and a folder."""

    def __init__(self, folder):
        self.folder, self.count = folder, 0
        self.environment = {**os.environ, "RIGCAL_DDS_LOCAL": "1"}
        self.rig = folder / "rig.yaml"
        self.rig.write_text(RIG)

    def words(self, verb, *more, tag):
        return [str(BIN / "rigcal"), verb, *map(str, more), "--ros-domain", "75", "--ros-tag", tag]

    def fresh_tag(self):
        return "record-" + uuid.uuid4().hex[:12]

    def record(self, tag, *more, **options):
        """Begun, and listening."""
        self.count += 1
        process = subprocess.Popen(self.words("record", self.rig, *more, "--json", tag=tag), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=self.environment, **options)
        line = process.stderr.readline()
        check(line.startswith("Recording 3 sensors in ROS domain 75 to "), "it begins: " + line)
        return process

    def replay(self, tag, bag, *more, exit_code=GOOD):
        done = subprocess.run(self.words("replay", bag, "--json", *more, tag=tag), capture_output=True, text=True, env=self.environment, timeout=300)
        check(done.returncode == exit_code, "replay: exit %d: %s" % (done.returncode, done.stderr))
        return json.loads(done.stdout), done.stderr

    def rigcal(self, *words, exit_code=GOOD):
        done = subprocess.run([str(BIN / "rigcal"), *map(str, words)], capture_output=True, text=True, env=self.environment, timeout=300)
        check(done.returncode == exit_code, "rigcal %s: exit %d: %s" % (words[0], done.returncode, done.stderr))
        return done


def stop(process, exit_code=GOOD, signal_number=signal.SIGINT):
    """Its last document that is no progress, all that it said, and all documents."""
    process.send_signal(signal_number)
    out, err = process.communicate(timeout=120)
    check(exit_code is None or process.returncode == exit_code, "record: exit %d instead of %r: %s" % (process.returncode, exit_code, err))
    documents = [json.loads(line) for line in out.splitlines()]
    recorded = [document for document in documents if document.get("kind") == "recorded"]
    return recorded[-1] if recorded else None, err, documents


def until_all_said(process, *words):
    """Reads what it says until there was a sentence with each of these words, in whatever order; these."""
    found = {}
    for line in process.stderr:
        found.update((one, line) for one in words if one in line)
        if len(found) == len(words):
            return [found[one] for one in words]
    return check(False, "it says: %r" % (words,))


def until_said(process, words):
    return until_all_said(process, words)[0]


def bag_of(path, left="sensor_msgs/CompressedImage", count=COUNT, tiff=()):
    """`tiff`: pictures that no session takes. Two cameras and a tool that is carried by a moving arm, of which one joint never moves."""
    messages = []
    for k in range(count):
        stamp_ns = START_NS + k * 50_000_000
        picture = writer.compressed("cdr", stamp_ns, "jpeg", b"\xff\xd8\xff\xe0" + bytes((k + j) % 251 for j in range(40_000 + k)))
        front = writer.cloud("cdr", stamp_ns, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7)], 12, bytes(1200)) if left == "sensor_msgs/PointCloud2" else picture
        if k in tiff:
            front = writer.compressed("cdr", stamp_ns, "tiff", b"II*\0" + bytes(1000))
        messages += [("/left", stamp_ns, front), ("/right", stamp_ns + 1000, picture),
                     ("/tf", stamp_ns, writer.transforms("cdr", stamp_ns, [("base", "arm", (0.01 * k, 0.25, 1 / 3), (0, 0, 0, 1))]))]
    static = writer.transforms("cdr", START_NS, [("arm", "tool", (0, 0, 0.1), (0, 0, 0.6, 0.8))])
    kinds = {"/left": left, "/right": "sensor_msgs/CompressedImage", "/tf": "tf2_msgs/TFMessage", "/tf_static": "tf2_msgs/TFMessage"}
    topics = {name: (kind.replace("/", "/msg/"), writer.definition(kind, 2)) for name, kind in kinds.items()}
    writer.mcap(path, [("/tf_static", START_NS, static), *messages], topics)
    return path


def topic_of(document, name):
    row, = [row for row in document["topics"] if row["topic"] == name]
    return row


def files_of(session):
    """{name: bytes}, without what names the bag; session.yaml without its date, which is when the bag was recorded."""
    found = {str(path.relative_to(session)): path.read_bytes() for path in sorted(session.rglob("*")) if path.is_file() and not path.name.startswith(".")}
    found["session.yaml"] = re.sub(rb"(?m)^captured_at: .*$", b"", found["session.yaml"])
    return found


def same_files(session, wanted_session):
    found, wanted = files_of(session), files_of(wanted_session)
    differ = sorted(name for name in found.keys() | wanted.keys() if found.get(name) != wanted.get(name))
    check(not differ, "the session is that of the bag, but for %r: %r instead of %r" % (
        differ, found.get(differ[0], b"")[:300] if differ else "", wanted.get(differ[0], b"")[:300] if differ else ""))


def padded(data):
    return data + bytes(-len(data) % 4)


def live_is_the_bag(live, bag):
    """Every message byte for byte, and every file of the session."""
    tag, kept, out = live.fresh_tag(), live.folder / "kept.mcap", live.folder / "live"
    recording = live.record(tag, "--bag", kept, "--out", out)
    told, _ = live.replay(tag, bag, "--rate", 2, "--wait", 60)
    check(told["whole"] and all(topic["sent"] == topic["in_bag"] and topic["readers"] == 1 for topic in told["topics"]), "all was sent: %r" % told)
    check(told["took_ns"] >= 0.9 * told["bag_ns"] / 2, "at the bag's pace: %r" % told)
    until_said(recording, "ended after")
    recorded, said, documents = stop(recording)
    check(recorded["whole"] and recorded["messages"] == 3 * COUNT + 1, "nothing is lost: %r" % recorded)
    row = topic_of(recorded, "/left")
    check(row["messages"] == COUNT and row["missed"] == 0 and row["types"] == ["sensor_msgs/msg/CompressedImage"] and not row["best_effort"], "a topic: %r" % row)
    check(15 < row["rate_hz"] < 60, "the rate at twice the pace: %r" % row)
    check(documents[-1]["session"] == str(out) and documents[-1]["captures"] == COUNT, "the session is told: %r" % documents[-1])
    wanted = {}
    for name, _, data in messages_in(bag):
        wanted.setdefault(name, []).append(padded(data))
    messages, topics = mcap_reader.read(kept)
    for name, sent in wanted.items():
        check([padded(data) for topic, _, _, data in messages if topic == name] == sent, "the bytes of " + name)
        check(topics[name][1] == "ros2msg" and topics[name][2], "its definition is there: " + name)
    live.rigcal("import", bag, "--rig", live.rig, "--out", live.folder / "of-bag")
    same_files(out, live.folder / "of-bag")
    check(not (live.folder / "live.recording.mcap").exists(), "nothing is left beside it")
    return kept


def messages_in(bag):
    """[(topic, log_ns, bytes)] of a bag of `bag_of`, whose chunks have no index."""
    data, at, names, found = bag.read_bytes(), 8, {}, []

    def walk(data, at):
        for op, content in mcap_reader.records_between(data, at, len(data)):
            if op == mcap_reader.CHANNEL:
                names[int.from_bytes(content[:2], "little")] = mcap_reader.blocks(content, 4, 1)[0][0].decode()
            elif op == mcap_reader.MESSAGE:
                found.append((names[int.from_bytes(content[:2], "little")], int.from_bytes(content[6:14], "little"), content[22:]))
            elif op == mcap_reader.CHUNK:
                walk(content, mcap_reader.blocks(content, 28, 1)[1] + 8)
    walk(data[:-8], at)
    return found


def a_program_of_ros2_hears_it(live, bag):
    """A reader that was made for the type, with the QoS of tf2_ros's listener and a configuration of its own (ros_reader.cc)."""
    tag = live.fresh_tag()
    configuration = ("<CycloneDDS><Domain Id='any'><General><Interfaces><NetworkInterface name='lo'/></Interfaces><AllowMulticast>spdp</AllowMulticast>"
                     "</General><Discovery><Tag>%s</Tag><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>"
                     "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>" % tag)
    reader = subprocess.Popen([str(BIN / "ros_reader"), "75", "rt/tf_static", "tf", "1", "60"], stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "CYCLONEDDS_URI": configuration})
    try:
        check(json.loads(reader.stdout.readline())["ready"], "the reader is there")
        live.replay(tag, bag, "--rate", 100, "--wait", 60, "--topics", "/tf_static")
        heard = json.loads(reader.communicate(timeout=120)[0])
    finally:
        reader.kill()
        reader.communicate()
    sent, = [data for topic, _, data in messages_in(bag) if topic == "/tf_static"]
    check(heard["type"] == "tf2_msgs::msg::dds_::TFMessage_" and heard["reliable"] and heard["transient_local"], "as tf2_ros offers it: %r" % heard)
    check(padded(bytes.fromhex(heard["cdr"])[4:]) == padded(sent[4:]), "its bytes: %r" % heard)


def a_publisher_that_comes_again(live, bag):
    tag, kept = live.fresh_tag(), live.folder / "again.mcap"
    recording = live.record(tag, "--bag", kept)
    live.replay(tag, bag, "--rate", 20, "--wait", 60, "--topics", "/left", "/right")
    until_said(recording, "/right (right): its publisher ended after %d messages" % COUNT)
    live.replay(tag, bag, "--rate", 20, "--wait", 60, "--topics", "/left", "/right")
    until_said(recording, "/right (right): its publisher ended after %d messages" % (2 * COUNT))
    recorded, said, _ = stop(recording, exit_code=MORE)
    check(topic_of(recorded, "/left")["messages"] == 2 * COUNT, "both times: %r" % recorded)
    check(topic_of(recorded, "/tf")["state"] == "nobody_publishes" and not recorded["whole"], "and what nobody publishes: %r" % recorded)


def two_at_once_are_each_heard_as_they_offer(live, bag):
    """One is reliable and one is best effort: no message comes twice, and of the reliable one all."""
    tag, kept = live.fresh_tag(), live.folder / "two.mcap"
    recording = live.record(tag, "--bag", kept)
    both = [subprocess.Popen(live.words("replay", bag, "--rate", 2, "--wait", 60, *more, tag=tag), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=live.environment)
            for more in ((), ("--best-effort",))]
    check([one.wait(timeout=120) for one in both] == [GOOD, GOOD], "both play")
    until_said(recording, "/right (right): its publisher ended")
    recorded, _, _ = stop(recording, exit_code=None)
    row = topic_of(recorded, "/left")
    check(row["messages"] + row["missed"] in (2 * COUNT, 2 * COUNT - 1) and row["messages"] > COUNT and row["best_effort"], "each once: %r" % row)
    messages, _ = mcap_reader.read(kept)
    counts = {}
    for topic, _, _, data in messages:
        if topic == "/left":
            counts[padded(data)] = counts.get(padded(data), 0) + 1
    wanted = {padded(data) for topic, _, data in messages_in(bag) if topic == "/left"}
    check(counts.keys() == wanted and max(counts.values()) == 2, "all of the reliable one, none three times: %r" % sorted(counts.values()))


def what_is_amiss_is_told(live):
    """A topic of another type, one under another name, and best effort."""
    tag, kept = live.fresh_tag(), live.folder / "amiss.mcap"
    live.rig.write_text(RIG.replace("/right", "/rihgt"))
    bag = bag_of(live.folder / "cloud.mcap", "sensor_msgs/PointCloud2", 60)
    played = subprocess.Popen(live.words("replay", bag, "--best-effort", "--wait", "15", tag=tag), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True, env=live.environment)
    until_said(played, "Publishing 4 topics")  # and waits for readers of two that nobody reads
    recording = live.record(tag, "--bag", kept)
    said = until_all_said(recording, "/left (left) is published as sensor_msgs/msg/PointCloud2", "nobody publishes /rihgt (right)")
    check("mend its `topic` or `type` in rig.yaml" in said[0], "what to do: " + said[0])
    check("did you mean /right?" in said[1] and "other topics are published in ROS domain 75" in said[1], "the near one is named: " + said[1])
    err = played.communicate(timeout=120)[1]
    until_said(recording, "/tf (tool): its publisher ended")
    check("/left: nobody in ROS domain 75 reads it" in err, "the player tells, too: " + err)
    recorded, _, _ = stop(recording, exit_code=MORE)
    live.rig.write_text(RIG)
    row = topic_of(recorded, "/tf")
    check(row["best_effort"] and row["messages"] + row["missed"] >= 59, "every message came or is counted: %r" % row)
    check(topic_of(recorded, "/left")["messages"] == 0 and topic_of(recorded, "/tf_static")["best_effort"] is False, "%r" % recorded)


def what_the_session_lacks_is_in_the_recording(live):
    tag, out = live.fresh_tag(), live.folder / "lacks"
    recording = live.record(tag, "--out", str(out) + "/")
    live.replay(tag, bag_of(live.folder / "lacks-drive.mcap", tiff=(3,)), "--rate", 2, "--wait", 60)
    until_said(recording, "ended after")
    recorded, said, _ = stop(recording, exit_code=MORE)
    left = live.folder / "lacks.recording.mcap"
    check(recorded["whole"] and left.exists() and "The recording is kept in %s" % left in said, "it stays: " + said)


def killed_it_is_a_bag(live, bag):
    tag, out = live.fresh_tag(), live.folder / "killed"
    recording = live.record(tag, "--out", out)
    live.replay(tag, bag, "--rate", 2, "--wait", 60)
    until_said(recording, "/left (left): its publisher ended")
    while True:  # what came is in the file a second later, and it tells itself each second
        line = json.loads(recording.stdout.readline())
        if topic_of(line, "/left")["state"] == "ended" and topic_of(line, "/left")["since_last_ns"] > 1_500_000_000:
            break
    recording.kill()
    recording.communicate()
    left = live.folder / "killed.recording.mcap"
    done = live.rigcal("import", left, "--list", "--json", exit_code=MORE)
    check(json.loads(done.stdout)["messages"] == 3 * COUNT + 1 and done.stderr.count("\n") == 1, "all that came is in it: " + done.stderr)
    said = subprocess.run(live.words("record", live.rig, "--out", out, tag=tag), capture_output=True, text=True, env=live.environment)
    check(said.returncode == REFUSED and "rigcal import" in said.stderr and str(left) in said.stderr, "and it is not overwritten: " + said.stderr)
    live.rigcal("import", left, "--rig", live.rig, "--out", out, exit_code=MORE)
    same_files(out, live.folder / "of-bag")


def a_full_disk_is_told(live, bag):
    """The system's limit on the size of a file stands for a full disk."""
    def small():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1_500_000, resource.RLIM_INFINITY))
    tag, kept = live.fresh_tag(), live.folder / "full.mcap"
    recording = live.record(tag, "--bag", kept, preexec_fn=small)
    live.replay(tag, bag, "--rate", 0.5, "--wait", 60)
    out, err = recording.communicate(timeout=120)  # it ends by itself
    check(recording.returncode == REFUSED and "full.mcap: cannot be written" in err, "exit %d: %s" % (recording.returncode, err))
    recorded = json.loads(out.splitlines()[-1])
    done = live.rigcal("import", kept, "--list", "--json", exit_code=MORE)
    check(json.loads(done.stdout)["messages"] == recorded["messages"] > 0, "what it counts is in the bag: %r" % recorded)
    arrived = sum(row["messages"] - row["unwritten"] for row in recorded["topics"])
    check(arrived == recorded["messages"] + recorded["unwritten"] and recorded["unwritten"] > 0, "the rest is counted: %r" % recorded)


def refusals(live, bag):
    tag = live.fresh_tag()
    done = subprocess.run(live.words("record", live.rig, "--bag", live.folder / "none.mcap", "--for", 1, tag=tag), capture_output=True, text=True,
                          env=live.environment)
    check(done.returncode == UNREACHABLE and "nothing was recorded in ROS domain 75" in done.stderr, "nobody is there: " + done.stderr)
    check(not (live.folder / "none.mcap").exists(), "and no empty bag")
    done = subprocess.run(live.words("record", live.rig, "--out", str(live.folder / "slash") + "/", "--for", 1, tag=tag), capture_output=True, text=True,
                          env=live.environment)
    check(done.returncode == UNREACHABLE and "slash.recording.mcap" in done.stderr, "a folder with a slash, as the help has it: " + done.stderr)
    done = subprocess.run(live.words("replay", bag, "--topics", "/lefd", tag=tag), capture_output=True, text=True, env=live.environment)
    check(done.returncode == REFUSED and "did you mean /left?" in done.stderr, "a topic that the bag lacks: " + done.stderr)
    old = live.folder / "old.bag"
    writer.ros1(old, [("/left", START_NS, writer.compressed("ros1", START_NS, "jpeg", b"\xff\xd8"))],
                {"/left": ("sensor_msgs/CompressedImage", writer.definition("sensor_msgs/CompressedImage", 1))})
    done = subprocess.run(live.words("replay", old, tag=tag), capture_output=True, text=True, env=live.environment)
    check(done.returncode == REFUSED and "ROS 2 sends cdr" in done.stderr and done.stderr.count("\n") == 1, "a bag of ROS 1: " + done.stderr)


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-record-") as name:
        live = Live(pathlib.Path(name))
        bag = bag_of(live.folder / "drive.mcap")
        live_is_the_bag(live, bag)
        a_program_of_ros2_hears_it(live, bag)
        a_publisher_that_comes_again(live, bag)
        two_at_once_are_each_heard_as_they_offer(live, bag)
        what_is_amiss_is_told(live)
        what_the_session_lacks_is_in_the_recording(live)
        killed_it_is_a_bag(live, bag)
        a_full_disk_is_told(live, bag)
        refusals(live, bag)
    print("record: good")


main()
