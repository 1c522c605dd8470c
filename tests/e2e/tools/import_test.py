"""`rigcal import`: one drive in every container gives the same session, byte by byte; what is in it is what was sent; a cut bag gives what it has."""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import check  # noqa: E402
from measures.tools.bags import writer as bag_writer  # noqa: E402

RIGCAL = pathlib.Path(os.environ["RIGCAL_BIN"]) / "rigcal"
GOOD, USAGE, REFUSED, MORE = 0, 2, 4, 5
START_NS, PERIOD_NS, FRAMES = 1_700_000_000_000_000_000, 100_000_000, 12
WIDTH, HEIGHT, STEP = 8, 6, 8 * 3 + 5  # rows are longer than their pixels
FIELDS, POINT_STEP = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 16, 7), ("ring", 20, 4)], 24
KINDS = {"/left/image_raw": "sensor_msgs/Image", "/right/image_raw": "sensor_msgs/Image", "/lidar/points": "sensor_msgs/PointCloud2",
         "/odom": "nav_msgs/Odometry", "/tf": "tf2_msgs/TFMessage", "/tf_static": "tf2_msgs/TFMessage"}
ROI = "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"
CAMERA_INFO = {ros: "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] %s\nfloat64[9] %s\nfloat64[9] %s\nfloat64[12] %s\n"
               "uint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n" % tuple(names) +
               bag_writer.definition("sensor_msgs/CompressedImage", ros).split("uint8[] data\n", 1)[1] + "=" * 80 + "\nMSG: sensor_msgs/RegionOfInterest\n" + ROI
               for ros, names in ((1, "DKRP"), (2, "dkrp"))}
RIG = """format: 1
robot: mapper-01
import: {tolerance_s: 0.005}
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  left: {type: camera, topic: /left/image_raw, sees: board}
  right: {type: camera, topic: /right/image_raw}
  top: {type: lidar, topic: /lidar/points}
  odom: {type: pose_stream, topic: /odom}
  flange: {type: tracker, topic: /tf, frame: base, child_frame: tool}
"""


def rigcal(*words, exit_code=GOOD):
    done = subprocess.run([str(RIGCAL), *map(str, words)], capture_output=True, text=True, timeout=120)
    check(done.returncode == exit_code, "rigcal %s: exit %d instead of %d: %s%s" % (
        " ".join(map(str, words)), done.returncode, exit_code, done.stdout, done.stderr))
    check("terminate called" not in done.stderr, "no stack trace: " + done.stderr)
    return done


def bgr_of(k):
    return [b"".join(bytes((k, x * 20 + y, 255 - x)) for x in range(WIDTH)) for y in range(HEIGHT)]


def grey_of(k):
    return [bytes((k * 10 + x + 8 * y) % 256 for x in range(WIDTH)) for y in range(HEIGHT)]


def points_of(k):
    return [(1.0 + k, 2.0 + i, -0.5 * i, 0.25 * i, 3 * i) for i in range(5)]


def drive(form):
    """[(topic, log_ns, bytes)]: the right camera is 2 ms later and misses frame 4, the lidar is 1 ms earlier and takes every other frame."""
    half = 0.5 ** 0.5
    messages = [("/tf_static", START_NS, bag_writer.transforms(form, START_NS, [("arm", "tool", (0.0, 0.0, 0.25), (0.0, 0.0, 0.0, 1.0))]))]
    for k in range(FRAMES):
        stamp = START_NS + k * PERIOD_NS
        log = stamp + 3_000_000
        left = b"".join(row + b"\xEE" * 5 for row in bgr_of(k))
        messages.append(("/tf", log, bag_writer.transforms(form, stamp + 1000, [("base", "arm", (float(k), 0.0, 0.0), (0.0, half, 0.0, half))])))
        messages.append(("/left/image_raw", log, bag_writer.image(form, stamp, WIDTH, HEIGHT, "bgr8", left, STEP)))
        if k != 4:
            messages.append(("/right/image_raw", log + 1, bag_writer.image(form, stamp + 2_000_000, WIDTH, HEIGHT, "mono8", b"".join(grey_of(k)), WIDTH)))
        if k % 2 == 0:
            data = b"".join(struct.pack("<3f4xfH2x", *point) for point in points_of(k))
            messages.append(("/lidar/points", log + 2, bag_writer.cloud(form, stamp - 1_000_000, FIELDS, POINT_STEP, data)))
        messages.append(("/odom", log + 3, bag_writer.odometry(form, stamp, (0.1 * k, 0.2, 0.3), (0.0, 0.0, 0.6, 0.8))))
    return messages


def topics(ros, long_names=True):
    def spelt(kind):
        return kind.replace("/", "/msg/") if ros == 2 and long_names else kind
    return {name: (spelt(kind), bag_writer.definition(kind, ros)) for name, kind in KINDS.items()}


def program(name, *words):
    return lambda data: subprocess.run([name, *words], input=data, capture_output=True, check=True).stdout


def bags_in(folder):
    """{name: path} of the same drive."""
    cdr, made = drive("cdr"), {}

    def place(name):
        made[name] = folder / name
        return made[name]
    bag_writer.mcap(place("plain.mcap"), cdr, topics(2))
    bag_writer.mcap(place("big_endian.mcap"), drive("cdr_big"), topics(2))
    if shutil.which("zstd"):
        bag_writer.mcap(place("zstd.mcap"), cdr, topics(2), ("zstd", program("zstd", "-q", "-c")))
        place("file.mcap.zstd").write_bytes(program("zstd", "-q", "-c")((folder / "plain.mcap").read_bytes()))
        bag_writer.database(place("each.db3"), cdr, topics(2), 3, program("zstd", "-q", "-c"))
    if shutil.which("lz4"):
        bag_writer.mcap(place("lz4.mcap"), cdr, topics(2), ("lz4", program("lz4", "-q", "-c")))
    for version in (1, 2, 3, 4):
        bag_writer.database(place("schema_%d.db3" % version), cdr, topics(2, version > 1), version)
    bag_writer.ros1(place("plain.bag"), drive("ros1"), topics(1))
    bag_writer.ros1(place("bz2.bag"), drive("ros1"), topics(1), "bz2")
    split = place("split")
    split.mkdir()
    bag_writer.mcap(split / "split_0.mcap", cdr[:20], topics(2))
    bag_writer.mcap(split / "split_1.mcap", cdr[20:], topics(2))
    (split / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n"
                                         "    - split_0.mcap\n    - split_1.mcap\n  topics_with_message_count: []\n")
    return made


def session_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file() and not path.name.startswith(".")}


def pixels_of(png):
    """(width, height, rows) of an 8-bit PNG."""
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IHDR":
            width, height, _, colour = struct.unpack(">IIBB", png[at + 8:at + 18])
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + size]
        at += 12 + size
    raw, count = zlib.decompress(data), {0: 1, 2: 3}[colour]
    rows, above = [], bytes(width * count)
    for y in range(height):
        line = raw[y * (width * count + 1):(y + 1) * (width * count + 1)]
        above = unfiltered(line[0], line[1:], above, count)
        rows.append(above)
    return width, height, rows


def unfiltered(kind, line, above, count):
    row = bytearray()
    for i, value in enumerate(line):
        a, b, c = row[i - count] if i >= count else 0, above[i], above[i - count] if i >= count else 0
        paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        row.append((value + (0, a, b, (a + b) // 2, paeth)[kind]) % 256)
    return bytes(row)


def stem(k):
    """The sensor with the fewest messages names a capture: the lidar, else the right camera."""
    stamp = START_NS + k * PERIOD_NS + (2_000_000 if k % 2 else -1_000_000)
    return "%d-%09d" % divmod(stamp, 10**9)


def content_is_what_was_sent(session):
    for k in range(FRAMES):
        width, height, rows = pixels_of(session["left/%s.png" % stem(k)])
        check((width, height) == (WIDTH, HEIGHT), "the picture's size")
        wanted = [b"".join(row[i:i + 3][::-1] for i in range(0, len(row), 3)) for row in bgr_of(k)]  # PNG has red first
        check(rows == wanted, "left %d: %r" % (k, rows[0]))
        if k != 4:
            check(pixels_of(session["right/%s.png" % stem(k)])[2] == grey_of(k), "right %d" % k)
        if k % 2 == 0:
            head, body = session["top/%s.pcd" % stem(k)].split(b"DATA binary\n")
            check(b"FIELDS x y z intensity ring\nSIZE 4 4 4 4 2\nTYPE F F F F U\n" in head, "the PCD's fields: %r" % head)
            check(list(struct.iter_unpack("<4fH", body)) == points_of(k), "the points of %d" % k)
    check("right/%s.png" % stem(4) not in session, "what was not sent is not there")
    odom = session["odom/poses.csv"].decode().splitlines()
    check(odom[1] == "%d,0,0.2,0.3,0,0,0.6,0.8" % START_NS and len(odom) == FRAMES + 1, "odometry: %r" % odom[:2])
    # base -> arm turns by 90 deg about y: 0.25 m along the arm's z lies along the base's x.
    name, stamp, *numbers = session["flange/poses.csv"].decode().splitlines()[1].split(",")
    check((name, int(stamp)) == (stem(0), START_NS + 1000), "the flange's row: %s %s" % (name, stamp))
    check(max(abs(float(a) - b) for a, b in zip(numbers, (0.25, 0, 0, 0, 0.5 ** 0.5, 0, 0.5 ** 0.5))) < 1e-9, "the flange's pose: %r" % numbers)
    check('captured_at: "2023-11-14T22:13:20Z"' in session["session.yaml"].decode(), session["session.yaml"].decode())


def every_container_gives_the_same(folder, rig):
    sessions = {}
    for name, bag in bags_in(folder).items():
        out = folder / ("session of " + name)
        rigcal("import", bag, "--rig", rig, "--out", out)
        sessions[name] = session_of(out)
        check(sessions[name] == sessions["plain.mcap"], "%s gives the same bytes: %r" % (name, sorted(sessions[name])[:5]))
    content_is_what_was_sent(sessions["plain.mcap"])


def interrupted_goes_on(folder, rig):
    bag, out = folder / "plain.mcap", folder / "session of plain.mcap"
    before = session_of(out)
    check("already" in rigcal("import", bag, "--rig", rig, "--out", out).stdout, "a whole one is left alone")
    (out / "session.yaml").unlink()
    for path in sorted(out.glob("left/*"))[3:]:
        path.unlink()
    told = json.loads(rigcal("import", bag, "--rig", rig, "--out", out, "--json").stdout)
    check(session_of(out) == before, "what was cut off is made whole")
    check(told["kept_files"] == 3 + (FRAMES - 1) + FRAMES // 2, "only what is missing is written: %r" % told)
    refused = rigcal("import", folder / "plain.bag", "--rig", rig, "--out", out, exit_code=REFUSED).stderr
    check("another bag" in refused, refused)
    other = bytearray(bag.read_bytes())
    other[len(other) // 2] ^= 1
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / bag.name).write_bytes(other)
    refused = rigcal("import", folder / "elsewhere" / bag.name, "--rig", rig, "--out", out, exit_code=REFUSED).stderr
    check("another bag" in refused, "of the same name and size: " + refused)


def a_stated_clock_lays_stamps_on_the_rigs(folder, rig):
    """The right camera's stamps are 2 ms late: of the same tolerance, none is too far where that is stated."""
    text = RIG.replace("right: {type: camera, topic: /right/image_raw}", "right: {type: camera, topic: /right/image_raw, clock_offset_s: 0.1}")
    stated = folder / "stated.yaml"
    stated.write_text(text.replace("odom: {type: pose_stream, topic: /odom}", "odom: {type: pose_stream, topic: /odom, clock_offset_s: -0.5}"))
    rigcal("import", folder / "plain.mcap", "--rig", stated, "--out", folder / "stated")
    # 0.1 s are one frame: what the right camera stamped at frame k shows frame k - 1 of the others.
    matched = 0
    for right in sorted((folder / "stated/right").iterdir()):
        left = folder / "stated/left" / right.name
        k = next(k for k in range(FRAMES) if pixels_of(right.read_bytes())[2] == grey_of(k))
        if left.exists():
            matched += 1
            check(pixels_of(left.read_bytes())[2][0][2] == k - 1, "frame %d of the right camera with that before it of the left" % k)
    check(matched > FRAMES // 2, "most of them match: %d" % matched)
    first = (folder / "stated/odom/poses.csv").read_text().splitlines()[1]
    check(first.startswith("%d," % (START_NS + 500_000_000)), "the stream's stamps too: " + first)


def what_no_sensor_has_is_refused(folder):
    rig = folder / "mistaken.yaml"
    rig.write_text(RIG.replace("topic: /right/image_raw", "topic: /lidar/points").replace("{type: lidar, topic: /lidar/points", "{type: lidar, topic: /right/image_raw").replace("child_frame: tool", "child_frame: tol"))
    told = rigcal("import", folder / "plain.mcap", "--rig", rig, "--out", folder / "mistaken", exit_code=MORE).stdout
    check("are nothing that a camera has" in told and "are nothing that a lidar has" in told, told)
    check('no transform is of or in a frame "tol"' in told, told)
    check(not (folder / "mistaken/right").exists(), "no cloud under a camera")


def camera_info(form, stamp_ns, fx):
    out = bag_writer.Writer(form)
    out.header(stamp_ns, "optical")
    out.numbers("I", (HEIGHT, WIDTH))
    out.text("plumb_bob")
    out.number("I", 5)
    out.numbers("d", [0.0] * 5 + [fx, 0, 4, 0, 500, 3, 0, 0, 1] + [0.0] * 21)
    out.numbers("I", [0] * 6)
    out.number("?", False)
    return out.done()


def a_camera_info_that_changes_is_told(folder):
    """By its stamp: the pictures of before and after would be calibrated as one lens."""
    rig = folder / "left_alone.yaml"
    info = "/left/camera_info"
    for name, form, ros in (("zoomed.mcap", "cdr", 2), ("zoomed.bag", "ros1", 1)):
        messages = drive(form)
        for k in range(FRAMES):
            messages.append((info, START_NS + k, camera_info(form, START_NS + k * PERIOD_NS, 500 if k < 5 else 620)))
        spelt = {**topics(ros), info: ("sensor_msgs/msg/CameraInfo" if ros == 2 else "sensor_msgs/CameraInfo", CAMERA_INFO[ros])}
        (bag_writer.mcap if ros == 2 else bag_writer.ros1)(folder / name, messages, spelt)
        wanted = "/left/camera_info changes at 2023-11-14T22:13:20.5Z (stamp 1700000000.500000000): fx 500 to 620"
        told = rigcal("import", folder / name, "--list").stdout
        check(wanted + "." in told, told)
        told = rigcal("import", folder / name, "--rig", rig, "--out", folder / (name + "_out")).stdout
        check(wanted in told and "split the bag there" in told, told)
        again = json.loads(rigcal("import", folder / name, "--rig", rig, "--out", folder / (name + "_out"), "--json").stdout)
        check(again["was_complete"] and again["sensors"][0]["camera_change"] == wanted, "also of one that is whole: %r" % again)


def a_bag_that_was_mended_is_read_again(folder):
    """Its ends are the same, and what was lost lies between them."""
    pixels = bytes(range(1, 256)) * 80
    messages = [("/left/image_raw", START_NS + k * PERIOD_NS, bag_writer.image("cdr", START_NS + k * PERIOD_NS, 100, 204, "mono8", pixels, 100)) for k in range(30)]
    bag, out, rig = folder / "mended.mcap", folder / "mended", folder / "left_alone.yaml"
    rig.write_text("".join(line + "\n" for line in RIG.splitlines() if not line.startswith(("  right:", "  top:", "  odom:", "  flange:"))))
    bag_writer.mcap(bag, messages, {"/left/image_raw": topics(2)["/left/image_raw"]})
    whole = bag.read_bytes()
    bag.write_bytes(whole[:100_000] + bytes(250_000) + whole[350_000:])
    first = json.loads(rigcal("import", bag, "--rig", rig, "--out", out, "--json", exit_code=MORE).stdout)
    check(0 < first["captures"] < len(messages), "as far as it goes: %r" % first)
    check("already" in rigcal("import", bag, "--rig", rig, "--out", out, exit_code=MORE).stdout, "the same bag once more")
    bag.write_bytes(whole)
    refused = rigcal("import", bag, "--rig", rig, "--out", out, exit_code=REFUSED).stderr
    check("as it was" in refused and "other bytes between them" in refused, refused)
    # damage inside a picture is no damage that the bag shows, and a copy may keep the time of writing
    pixel = whole.index(pixels) + 5000 + 10 * len(pixels)
    check(64 << 10 < pixel < len(whole) - (64 << 10), "between the ends")
    bag.write_bytes(whole[:pixel] + bytes(500) + whole[pixel + 500:])
    written = os.stat(bag).st_mtime_ns
    rigcal("import", bag, "--rig", rig, "--out", folder / "grey", "--json")
    mended = folder / "elsewhere.mcap"
    mended.write_bytes(whole)
    os.utime(mended, ns=(written, written))
    mended.rename(bag)
    refused = rigcal("import", bag, "--rig", rig, "--out", folder / "grey", exit_code=REFUSED).stderr
    check("as it was" in refused, refused)
    bag.write_bytes(whole[:pixel] + bytes(500) + whole[pixel + 500:])
    check("already" in rigcal("import", bag, "--rig", rig, "--out", folder / "grey").stdout, "a copy of the same bytes is the same bag")


def what_had_no_partner_is_counted(folder, rig):
    out = folder / "thinned"
    told = json.loads(rigcal("import", folder / "plain.mcap", "--rig", rig, "--out", out, "--tolerance", 0.0005, "--json", exit_code=MORE).stdout)
    check(told["captures"] == 0, "nothing is within half a millisecond: %r" % told)
    check({s["id"]: s["without_partner"] for s in told["sensors"]}["left"] == FRAMES, "all are counted: %r" % told)
    told = json.loads(rigcal("import", folder / "plain.mcap", "--rig", rig, "--out", folder / "every", "--every", 0.35, "--json").stdout)
    check(told["captures"] == 3, "every 0.35 s of 1.1 s: %r" % told)


def cut_database_gives_what_it_has(folder):
    """SQLite itself refuses a file that was cut, or reads zeros for what is lost of a page."""
    pixels = bytes(range(1, 256)) * 80  # several pages each
    messages = [("/left/image_raw", START_NS + k, bag_writer.image("cdr", START_NS + k, 100, 204, "mono8", pixels, 100)) for k in range(20)]
    bag_writer.database(folder / "large.db3", messages, {"/left/image_raw": topics(2)["/left/image_raw"]}, 4)
    for name, count in (("schema_4.db3", len(drive("cdr"))), ("large.db3", len(messages))):
        whole = (folder / name).read_bytes()
        check(json.loads(rigcal("import", folder / name, "--list", "--json").stdout)["messages"] == count, "whole: " + name)
        counts = []
        for share in (0.3, 0.6, 0.9):
            (folder / "cut.db3").write_bytes(whole[:int(len(whole) * share)])
            done = rigcal("import", folder / "cut.db3", "--list", "--json", exit_code=MORE)
            check("is cut off: " in done.stderr and done.stderr.count("\n") == 1, "one sentence: %r" % done.stderr)
            counts.append(json.loads(done.stdout)["messages"])
        check(counts == sorted(counts) and count // 2 < counts[-1] < count, "as far as it goes: %r of %d" % (counts, count))


def cut_off_gives_what_it_has(folder, rig):
    whole = (folder / "plain.mcap").read_bytes()
    cut = folder / "cut.mcap"
    cut.write_bytes(whole[:len(whole) * 2 // 3])
    done = rigcal("import", cut, "--list", "--json", exit_code=MORE)
    told = json.loads(done.stdout)
    check(0 < told["messages"] < len(drive("cdr")) and len(told["damage"]) == 1, "what is there, and one sentence: %r" % told["damage"])
    check(done.stderr.count("\n") == 1 and done.stderr.startswith("rigcal: "), "one sentence: %r" % done.stderr)
    rigcal("import", cut, "--rig", rig, "--out", folder / "session of cut", exit_code=MORE)
    cut_database_gives_what_it_has(folder)
    for name, data in (("empty", b""), ("no_bag", b"hello, this is no bag")):
        (folder / name).write_bytes(data)
        check(rigcal("import", folder / name, "--list", exit_code=REFUSED).stderr.count("\n") == 1, "one sentence")


def first_rig_serves_the_next_bag(folder):
    rig = folder / "first.yaml"
    shown = rigcal("import", folder / "plain.mcap", "--list", "--write-rig", rig).stdout
    check("/lidar/points" in shown and "10.00" in shown, shown)
    text = rig.read_text()
    check("  left:\n    type: camera\n    topic: /left/image_raw" in text and "type: lidar" in text and "type: pose_stream" in text, text)
    refused = rigcal("import", folder / "plain.mcap", "--rig", rig, "--out", folder / "first", exit_code=REFUSED).stderr
    check("robot" in refused, "what a person has to fill in is asked for: " + refused)
    rig.write_text(text.replace("robot: ", "robot: r1").replace("  # board:", "  board:"))
    rigcal("import", folder / "plain.mcap", "--rig", rig, "--out", folder / "first")
    check((folder / "first/session.yaml").exists() and len(list((folder / "first/left").iterdir())) == FRAMES, "it imports")
    rigcal("import", folder / "plain.mcap", "--list", "--write-rig", rig, exit_code=REFUSED)


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-import-") as name:
        folder = pathlib.Path(name)
        rig = folder / "rig.yaml"
        rig.write_text(RIG)
        every_container_gives_the_same(folder, rig)
        interrupted_goes_on(folder, rig)
        a_stated_clock_lays_stamps_on_the_rigs(folder, rig)
        what_no_sensor_has_is_refused(folder)
        a_bag_that_was_mended_is_read_again(folder)
        a_camera_info_that_changes_is_told(folder)
        what_had_no_partner_is_counted(folder, rig)
        cut_off_gives_what_it_has(folder, rig)
        first_rig_serves_the_next_bag(folder)
        rigcal("import", folder / "plain.mcap", exit_code=USAGE)
    print("import: good")


main()
