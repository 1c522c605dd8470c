"""A session folder as a bag of every container: pictures as the files that they are, clouds as PointCloud2, poses as PoseStamped."""
import csv
import datetime
import re

from . import writer

CAPTURE_PERIOD_NS = 10 * 10**9
DATATYPES = {("I", 1): 1, ("U", 1): 2, ("I", 2): 3, ("U", 2): 4, ("I", 4): 5, ("U", 4): 6, ("F", 4): 7, ("F", 8): 8}
KINDS = {"camera": "sensor_msgs/CompressedImage", "lidar": "sensor_msgs/PointCloud2", "tracker": "geometry_msgs/PoseStamped"}


def sensors_of(session):
    """{sensor: kind} of session.yaml as the simulator writes it."""
    text = (session / "session.yaml").read_text()
    return dict(re.findall(r"(?m)^  (\w+):\n    type: (\w+)$", text.split("\nsensors:\n")[1]))


def start_ns(session):
    told = re.search(r"(?m)^captured_at: \"?(\S+?)\"?$", (session / "session.yaml").read_text()).group(1)
    begin = datetime.datetime.fromisoformat(told.replace("Z", "+00:00"))
    return int(begin.timestamp()) * 10**9


def rig_of(session, robot=None):
    """rig.yaml: session.yaml without its date, each sensor with its topic."""
    text = re.sub(r"(?m)^captured_at: .*\n", "", (session / "session.yaml").read_text())
    text = re.sub(r"(?m)^  (\w+):\n    type: (\w+)$", r"  \1:\n    type: \2\n    topic: /\1", text)
    return re.sub(r"(?m)^robot: .*$", "robot: " + robot, text) if robot else text


def fields_of_pcd(data):
    """[(name, offset, datatype)], bytes of a point, the points of a binary PCD."""
    head, body = data.split(b"DATA binary\n", 1)
    words = {line.split()[0]: line.split()[1:] for line in head.decode().splitlines() if line}
    fields, offset = [], 0
    for name, size, letter in zip(words["FIELDS"], words["SIZE"], words["TYPE"]):
        fields.append((name, offset, DATATYPES[letter, int(size)]))
        offset += int(size)
    return fields, offset, body[:int(words["POINTS"][0]) * offset]


def message_of(path, form, stamp_ns):
    data = path.read_bytes()
    if path.suffix == ".pcd":
        return writer.cloud(form, stamp_ns, *fields_of_pcd(data))
    return writer.compressed(form, stamp_ns, {".jpg": "jpeg", ".png": "png"}[path.suffix], data)


def rows_of(path):
    """(capture, stamp_ns, position, quaternion) of each row of a tracker's poses.csv."""
    with open(path, newline="") as file:
        for row in list(csv.reader(file))[1:]:
            numbers = [float(number) for number in row[2:]]
            yield row[0], int(row[1]), numbers[:3], numbers[3:]


def stamps_of(session, sensors):
    """{capture: stamp_ns}: the tracker's where there is one, else one every few seconds from the session's date on."""
    names = sorted({path.stem for sensor, kind in sensors.items() if kind != "tracker" for path in (session / sensor).iterdir()})
    stamps = {name: start_ns(session) + i * CAPTURE_PERIOD_NS for i, name in enumerate(names)}
    for sensor, kind in sensors.items():
        if kind == "tracker":
            stamps.update((capture, stamp_ns) for capture, stamp_ns, _, _ in rows_of(session / sensor / "poses.csv"))
    return stamps


def messages_of(session, form):
    """[(topic, log_ns, bytes)], by time."""
    sensors, messages = sensors_of(session), []
    stamps = stamps_of(session, sensors)
    for sensor, kind in sensors.items():
        if kind == "tracker":
            messages += [("/" + sensor, stamp_ns, writer.pose(form, stamp_ns, p, q)) for _, stamp_ns, p, q in rows_of(session / sensor / "poses.csv")]
        else:
            messages += [("/" + sensor, stamps[path.stem], message_of(path, form, stamps[path.stem])) for path in sorted((session / sensor).iterdir())]
    return sorted(messages, key=lambda message: message[1])


def topics_of(session, ros):
    return {"/" + sensor: (KINDS[kind].replace("/", "/msg/") if ros == 2 else KINDS[kind], writer.definition(KINDS[kind], ros))
            for sensor, kind in sensors_of(session).items()}


def bags_of(session, folder):
    """{container: path} of the same session."""
    cdr, topics = messages_of(session, "cdr"), topics_of(session, 2)
    writer.mcap(folder / "visit.mcap", cdr, topics)
    writer.database(folder / "visit.db3", cdr, topics, 4)
    writer.ros1(folder / "visit.bag", messages_of(session, "ros1"), topics_of(session, 1))
    return {"mcap": folder / "visit.mcap", "db3": folder / "visit.db3", "ros1": folder / "visit.bag"}
