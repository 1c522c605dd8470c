"""Live topics over DDS: `rigcal replay` of a bag that shares nothing with our reader, `rigcal record` beside it: the same poses as the bag's own
import, byte for byte the same messages, nothing lost at a robot's rates."""
import json
import os
import pathlib
import signal
import subprocess
import time
import uuid

from ..measure import at_least, at_most, equal, info
from .bags import big_bag, mcap_reader, session_bags, writer
from .import_bags import GOOD, POSE_DIFFERENCE_MAX, largest_difference, pushed, rigcal_import

DOMAIN = 76
PICTURES = {"front": 10, "left": 10, "right": 10, "rear": 10}  # Hz
PICTURE_BYTES = 1920 * 1200
SECONDS = 10


class Robot:
    """A ROS domain that nobody else is in."""

    def __init__(self, context):
        self.context = context
        self.place = ["--ros-domain", str(DOMAIN), "--ros-tag", "measure-" + uuid.uuid4().hex[:12]]
        self.environment = {**os.environ, "RIGCAL_DDS_LOCAL": "1"}

    def start(self, verb, *words):
        return subprocess.Popen([str(self.context.bin / "rigcal"), verb, *map(str, words), *self.place, "--json"], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, env=self.environment)

    def recorded(self, rig, bag, record_words, replay_words):
        """(the recorder's documents by kind, the player's, the recorder's peak of memory in MiB); a recording ends once its publishers did."""
        recorder = self.start("record", rig, *record_words)
        first = recorder.stderr.readline()
        if not first.startswith("Recording "):
            raise RuntimeError("record: " + first)
        player = self.start("replay", bag, *replay_words)
        played, error = player.communicate(timeout=1800)
        if player.returncode != GOOD:
            raise RuntimeError("replay: exit %d: %s" % (player.returncode, error[-300:]))
        for line in recorder.stderr:
            if "its publisher ended" in line:
                break
        peak_mib = next(int(line.split()[1]) / 1024 for line in open("/proc/%d/status" % recorder.pid) if line.startswith("VmHWM"))
        recorder.send_signal(signal.SIGINT)
        out, error = recorder.communicate(timeout=1800)
        documents = {document.get("kind", "session"): document for document in map(json.loads, out.splitlines())}
        if recorder.returncode != GOOD:
            raise RuntimeError("record: exit %d: %s" % (recorder.returncode, error[-300:]))
        return documents, json.loads(played), peak_mib


def same_messages(sent, bag):
    """How many of the messages that were sent are in the recording as they were, in their topic's order."""
    messages, _ = mcap_reader.read(bag)
    by_topic, same = {}, 0
    for topic, _, _, data in messages:
        by_topic.setdefault(topic, []).append(data)
    places = dict.fromkeys(by_topic, 0)
    for topic, _, data in sent:
        found, place = by_topic.get(topic, []), places.get(topic, 0)
        if place < len(found) and found[place].rstrip(b"\0") == data.rstrip(b"\0"):
            same, places[topic] = same + 1, place + 1
    return same, len(messages)


def live_session(context, folder):
    """As the measure `import` has it of files: the bag's own import is the reference."""
    session, rig = folder / "visit", folder / "rig.yaml"
    captures = 30 if context.full else 12
    context.run_json("rigcal", "simulate", "mars-mapper", "--out", session, "--scale", 0.5, "--captures", captures, "--json", timeout=1800)
    rig.write_text(session_bags.rig_of(session))
    sent, bag = session_bags.messages_of(session, "cdr"), folder / "visit.mcap"
    writer.mcap(bag, sent, session_bags.topics_of(session, 2))
    code, _, error, _ = rigcal_import(context, bag, "--rig", rig, "--out", folder / "of-bag")
    if code != GOOD:
        raise RuntimeError("import: exit %d: %s" % (code, error[-300:]))
    robot = Robot(context)
    documents, played, _ = robot.recorded(rig, bag, ["--out", folder / "live", "--bag", folder / "live.mcap"], ["--rate", 20, "--wait", 60])
    same, found = same_messages(sent, folder / "live.mcap")
    yield equal("messages_byte_for_byte", "%d/%d" % (same, found), "%d/%d" % (len(sent), len(sent)))
    yield equal("captures_live", documents["session"]["captures"], captures)
    wanted = pushed(context, folder / "store-bag", "mars-mapper", folder / "of-bag")
    yield at_least("poses_of_the_bag", len(wanted), 12)
    poses = pushed(context, folder / "store-live", "mars-mapper", folder / "live")
    yield at_most("recorded_largest_difference", largest_difference(poses, wanted), POSE_DIFFERENCE_MAX)


def rates(context, folder):
    """Four raw cameras of 2.3 megapixels at 10 Hz: 92 MB/s through two processes and onto the disk."""
    pixels, bag, rig = big_bag.noisy_pixels(1920, 1200), folder / "drive.mcap", folder / "rig.yaml"
    kind = ("sensor_msgs/msg/Image", writer.definition("sensor_msgs/Image", 2))
    messages = [("/" + name, stamp_ns, writer.image("cdr", stamp_ns, 1920, 1200, "mono8", pixels, 1920))
                for k in range(SECONDS * 10 if context.full else 30) for name in PICTURES for stamp_ns in [big_bag.START_NS + k * big_bag.PERIOD_NS]]
    writer.mcap(bag, messages, {"/" + name: kind for name in PICTURES})
    sensors = "".join("  %s: {type: camera, topic: /%s, sees: board}\n" % (name, name) for name in PICTURES)
    rig.write_text(big_bag.RIG.split("sensors:\n")[0] + "sensors:\n" + sensors)
    began = time.monotonic()
    documents, played, peak_mib = Robot(context).recorded(rig, bag, ["--bag", folder / "live.mcap"], ["--wait", 60])
    told = documents["recorded"]
    yield equal("raw_pictures_recorded", told["messages"], len(messages))
    yield equal("raw_pictures_lost", sum(topic["missed"] + topic["unwritten"] for topic in told["topics"]), 0)
    yield info("player_behind_the_bag", played["latest_ns"] * 1e-9, "s")
    yield at_most("record_peak_rss", peak_mib, 700.0, "MiB")
    yield info("recorded_in", time.monotonic() - began, "s")


def run(context):
    for part in (live_session, rates):
        with context.folder() as name:
            yield from part(context, pathlib.Path(name))
