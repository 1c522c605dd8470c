"""Small bags of every container, written from the formats' descriptions; shares nothing with the reader under test."""
import bz2
import sqlite3
import struct

HEADER2 = "builtin_interfaces/Time stamp\nstring frame_id\n"
TIME2 = "int32 sec\nuint32 nanosec\n"
PARTS = {
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Pose": "Point position\nQuaternion orientation\n",
    "geometry_msgs/PoseWithCovariance": "Pose pose\n# row by row\nfloat64[36] covariance\n",
    "geometry_msgs/Twist": "Vector3 linear\nVector3 angular\n",
    "geometry_msgs/TwistWithCovariance": "Twist twist\nfloat64[36] covariance\n",
    "geometry_msgs/Transform": "Vector3 translation\nQuaternion rotation\n",
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\nTransform transform\n",
    "sensor_msgs/PointField": "uint8 INT8=1\nuint8 FLOAT32 = 7\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
}
BODIES = {
    "sensor_msgs/Image": ("std_msgs/Header header\nuint32 height # rows\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n", []),
    "sensor_msgs/CompressedImage": ("std_msgs/Header header\nstring format\nuint8[] data\n", []),
    "geometry_msgs/PoseStamped": ("std_msgs/Header header\ngeometry_msgs/Pose pose\n", ["geometry_msgs/" + name for name in ("Pose", "Point", "Quaternion")]),
    "sensor_msgs/PointCloud2": ("std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\n"
                                "uint32 row_step\nuint8[] data\nbool is_dense\n", ["sensor_msgs/PointField"]),
    "nav_msgs/Odometry": ("std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n",
                          ["geometry_msgs/" + name for name in ("PoseWithCovariance", "Pose", "Point", "Quaternion", "TwistWithCovariance", "Twist", "Vector3")]),
    "tf2_msgs/TFMessage": ("geometry_msgs/TransformStamped[] transforms\n",
                           ["geometry_msgs/" + name for name in ("TransformStamped", "Transform", "Vector3", "Quaternion")]),
}


def definition(kind, ros):
    body, parts = BODIES[kind]
    rule = "=" * 80
    text = body
    for name in ["std_msgs/Header", *parts]:
        inner = PARTS.get(name) or (HEADER2 if ros == 2 else "uint32 seq\ntime stamp\nstring frame_id\n")
        text += "%s\nMSG: %s\n%s" % (rule, name, inner)
    return text + ("%s\nMSG: builtin_interfaces/Time\n%s" % (rule, TIME2) if ros == 2 else "")


class Writer:
    """CDR of either byte order, or ROS 1's serialisation."""

    def __init__(self, form):
        self.ros1, self.order = form == "ros1", ">" if form == "cdr_big" else "<"
        self.body = bytearray()

    def number(self, kind, value):
        size = struct.calcsize("=" + kind)
        if not self.ros1:
            self.body += bytes(-len(self.body) % size)
        self.body += struct.pack(self.order + kind, value)

    def numbers(self, kind, values):
        for value in values:
            self.number(kind, value)

    def text(self, text):
        data = text.encode() + (b"" if self.ros1 else b"\0")
        self.number("I", len(data))
        self.body += data

    def block(self, data):
        self.number("I", len(data))
        self.body += data

    def header(self, stamp_ns, frame):
        if self.ros1:
            self.number("I", 7)
        self.numbers("I", divmod(stamp_ns, 10**9))
        self.text(frame)

    def done(self):
        return bytes(self.body) if self.ros1 else (b"\0\0\0\0" if self.order == ">" else b"\0\1\0\0") + bytes(self.body)


def image(form, stamp_ns, width, height, encoding, pixels, step):
    out = Writer(form)
    out.header(stamp_ns, "optical")
    out.numbers("I", (height, width))
    out.text(encoding)
    out.number("B", 0)
    out.number("I", step)
    out.block(pixels)
    return out.done()


def compressed(form, stamp_ns, kind, data):
    out = Writer(form)
    out.header(stamp_ns, "optical")
    out.text(kind)
    out.block(data)
    return out.done()


def pose(form, stamp_ns, p, q_xyzw):
    out = Writer(form)
    out.header(stamp_ns, "world")
    out.numbers("d", [*p, *q_xyzw])
    return out.done()


def cloud(form, stamp_ns, fields, point_step, data):
    out = Writer(form)
    out.header(stamp_ns, "lidar")
    out.numbers("I", (1, len(data) // point_step, len(fields)))
    for name, offset, datatype in fields:
        out.text(name)
        out.number("I", offset)
        out.number("B", datatype)
        out.number("I", 1)
    out.number("?", False)
    out.numbers("I", (point_step, len(data)))
    out.block(data)
    out.number("?", True)
    return out.done()


def odometry(form, stamp_ns, p, q_xyzw):
    out = Writer(form)
    out.header(stamp_ns, "odom")
    out.text("base_link")
    out.numbers("d", [*p, *q_xyzw, *range(36), *range(6), *range(36)])
    return out.done()


def transforms(form, stamp_ns, items):
    out = Writer(form)
    out.number("I", len(items))
    for parent, child, p, q_xyzw in items:
        out.header(stamp_ns, parent)
        out.text(child)
        out.numbers("d", [*p, *q_xyzw])
    return out.done()


def block32(data):
    return struct.pack("<I", len(data)) + data


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def mcap(path, messages, topics, pack=None, closed=True, chunk_messages=7):
    """messages: [(topic, log_ns, bytes)]; topics: {name: (type, definition)}; pack: (name, function) of chunks."""
    names = list(topics)
    heads = b"".join(record(3, struct.pack("<H", i + 1) + block32(topics[name][0].encode()) + block32(b"ros2msg") + block32(topics[name][1].encode()))
                     + record(4, struct.pack("<HH", i, i + 1) + block32(name.encode()) + block32(b"cdr") + block32(b"")) for i, name in enumerate(names))
    out = b"\x89MCAP0\r\n" + record(1, block32(b"ros2") + block32(b"bag_writer.py"))
    for begin in range(0, len(messages), chunk_messages):
        part = messages[begin:begin + chunk_messages]
        records = heads + b"".join(record(5, struct.pack("<HIQQ", names.index(topic), 0, log_ns, log_ns) + data) for topic, log_ns, data in part)
        packed = pack[1](records) if pack else records
        out += record(6, struct.pack("<QQQI", part[0][1], part[-1][1], len(records), 0) + block32((pack[0] if pack else "").encode()) +
                      struct.pack("<Q", len(packed)) + packed)
    if closed:
        out += record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + b"\x89MCAP0\r\n"
    path.write_bytes(out)


def database(path, messages, topics, schema_version, pack=None):
    base = sqlite3.connect(path)
    if schema_version >= 3:
        base.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
        base.execute("INSERT INTO schema VALUES (?, 'x')", (schema_version,))
    more = {1: "", 2: ", offered_qos_profiles TEXT NOT NULL", 3: ", offered_qos_profiles TEXT NOT NULL",
            4: ", offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL"}[schema_version]
    base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL%s)" % more)
    base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    names = list(topics)
    for i, name in enumerate(names):
        base.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr'%s)" % (", ''" * more.count(",")), (i + 1, name, topics[name][0]))
    if schema_version >= 4:
        base.execute("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL, "
                     "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)")
        for kind, text in set(topics.values()):
            base.execute("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, type_description_hash) "
                         "VALUES (?, 'ros2msg', ?, '')", (kind, text))
    base.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                     [(names.index(topic) + 1, log_ns, pack(data) if pack else data) for topic, log_ns, data in messages])
    base.commit()
    base.close()


def fields(**values):
    return b"".join(block32(name.encode() + b"=" + value) for name, value in values.items())


def ros1_record(head, data):
    return block32(head) + block32(data)


def ros1(path, messages, topics, packing="none"):
    names = list(topics)
    connections = b"".join(ros1_record(fields(op=b"\7", conn=struct.pack("<I", i), topic=name.encode()),
                                       fields(topic=name.encode(), type=topics[name][0].encode(), md5sum=b"*", message_definition=topics[name][1].encode()))
                           for i, name in enumerate(names))
    records = connections + b"".join(
        ros1_record(fields(op=b"\2", conn=struct.pack("<I", names.index(topic)), time=struct.pack("<II", *divmod(log_ns, 10**9))), data)
        for topic, log_ns, data in messages)
    packed = bz2.compress(records) if packing == "bz2" else records
    head = ros1_record(fields(op=b"\3", index_pos=struct.pack("<Q", 0), conn_count=struct.pack("<I", len(names)), chunk_count=struct.pack("<I", 1)), b" " * 4000)
    path.write_bytes(b"#ROSBAG V2.0\n" + head +
                     ros1_record(fields(op=b"\5", compression=packing.encode(), size=struct.pack("<I", len(records))), packed))
