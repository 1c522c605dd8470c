"""The table of bad inputs: how each is made, and the sentence it gets. No case may stop the server or be stored unseen.

A case is (name, what is done, pattern of the sentence, ...). Patterns are matched at the beginning.
"""
import json
import os
import pathlib
import struct
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from bad_session import LIDAR_YAML, YAML, pcd, ply, png, pictures, points  # noqa: E402

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
GOOD = pictures()


class Case:
    """kind: 'push' and 'edges' are refused with exit code 4 and nothing is stored; 'stored' gives a failed edge, 'noted' a
    good or failed edge, whose diagnoses or captures have the sentence; 'wire' runs hostile_client."""

    def __init__(self, kind, name, expected, make):
        self.kind, self.name, self.expected, self.make = kind, name, expected, make


def write(folder, yaml, files):
    folder.mkdir(parents=True)
    (folder / "session.yaml").write_bytes(yaml if isinstance(yaml, bytes) else yaml.encode())
    for path, content in files.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(content)
    return folder


def swapped(text, old, new):
    assert old in text, old
    return text.replace(old, new, 1)


def few(count=2):
    return {path: content for path, content in GOOD.items() if int(path[-6:-4]) <= count}


def yaml_case(name, expected, *swaps, kind="push", files=None, base=YAML):
    """The good session with parts of its session.yaml replaced."""
    def make(folder, robot):
        text = base
        for old, new in swaps:
            text = swapped(text, old, new)
        return write(folder, text.replace("ROBOT", robot), few() if files is None else files)
    return Case(kind, name, expected, make)


def raw_yaml_case(name, expected, content):
    """A session.yaml of these very bytes."""
    return Case("push", name, expected, lambda folder, robot: write(folder, content, few()))


def file_case(name, expected, path, content, kind="push", base=None, drop=()):
    """The good session with one file more, or other bytes in it."""
    def make(folder, robot):
        lidar = path.startswith("lidar/")
        files = {"left/01.png": GOOD["left/01.png"]} if lidar else few(6 if kind in ("stored", "noted") else 2)
        files[path] = content
        for gone in drop:
            del files[gone]
        return write(folder, (base or (LIDAR_YAML if lidar else YAML)).replace("ROBOT", robot), files)
    return Case(kind, name, expected, make)


def folder_case(name, expected, spoil):
    """The good session after something was done to its folder."""
    def make(folder, robot):
        write(folder, YAML.replace("ROBOT", robot), few())
        spoil(folder)
        return folder
    return Case("push", name, expected, make)


def cloud_case(name, expected, suffix, content):
    return file_case(name, expected, "lidar/01." + suffix, content, kind="stored")


IDENTITY = [[1e6 if row == column else 0.0 for column in range(6)] for row in range(6)]


def edge(**changes):
    made = {"frame_a": "a", "frame_b": "b", "T_a_b": {"p_m": [1.0, 0.0, 0.0], "q_xyzw": [0.0, 0.0, 0.0, 1.0]}, "information": IDENTITY}
    made.update(changes)
    return made


def with_entry(row, column, value):
    matrix = [list(line) for line in IDENTITY]
    matrix[row][column] = value
    return matrix


def edges_case(name, expected, text, suffix="json"):
    """A file for `rigcal push-edges`: JSON text, bytes, or edges. The sentence names it first."""
    def make(folder, robot):
        folder.mkdir(parents=True)
        path = folder / ("edges." + suffix)
        content = text() if callable(text) else text
        if isinstance(content, list):
            content = json.dumps({"format": 1, "edges": content})
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path
    return Case("edges", name, r"/\S+/edges\.%s: (?:%s)" % (suffix, expected), make)


def pose_case(name, expected, p_m=(0.0, 0.0, 0.0), q_xyzw=(0.0, 0.0, 0.0, 1.0)):
    return edges_case(name, expected, [edge(T_a_b={"p_m": list(p_m), "q_xyzw": list(q_xyzw)})])


def nominal_case(name, expected, p_m, q_xyzw):
    return yaml_case(name, expected, ("  right:\n    type: camera\n", "  right:\n    type: camera\n    T_ref_nominal: {p_m: %s, q_xyzw: %s}\n" % (p_m, q_xyzw)))


def wire_case(name, expected):
    return Case("wire", name, expected, None)


def g2o_case(name, expected, text):
    return edges_case(name, expected, text, suffix="g2o")


UPPER = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1"
G2O_EDGE = "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 " + UPPER + "\n"
FULL_WALL = points()
NAN = float("nan")
LONG = "x" * 10_000


PICTURES = [
    file_case("truncated PNG", r"1 picture of left cannot be read and take no part: 01\.", "left/01.png", GOOD["left/01.png"][:600], kind="noted"),
    file_case("PNG cut in its header", r"1 picture of left cannot be read .*header is cut off", "left/01.png", GOOD["left/01.png"][:20], kind="noted"),
    file_case("truncated JPEG", r"1 picture of left cannot be read .*header is cut off", "left/07.jpg", b"\xff\xd8\xff\xe0\x00\x10JFIF\x00\x01\x01\x00", kind="noted"),
    file_case("JPEG without its end", r"1 picture of left cannot be read .*the picture is cut off", "left/07.jpg",
              b"\xff\xd8\xff\xc0\x00\x0b\x08\x00\x40\x00\x40\x01\x01\x11\x00\xff\xda\x00\x08\x01\x01\x00\x00\x3f\x00" + b"x" * 200, kind="noted"),
    file_case("PNG of 100000 x 100000", r"1 picture of left cannot be read .*the picture claims 100000 x 100000 pixels", "left/01.png", png(100_000, 100_000, [b"\0" * 10]), kind="noted"),
    file_case("PNG of 2^31 x 2^31", r"1 picture of left cannot be read .*the picture is damaged: the size in its header is impossible", "left/01.png", png(2**31, 2**31, []), kind="noted"),
    file_case("PNG of 0 x 0", r"1 picture of left cannot be read .*the picture claims 0 x 0 pixels", "left/01.png", png(0, 0, []), kind="noted"),
    file_case("PNG with a wrong checksum", r"1 picture of left cannot be read", "left/01.png", GOOD["left/01.png"][:60] + b"\xff\xff" + GOOD["left/01.png"][62:], kind="noted"),
    file_case("PNG with less rows than it claims", r"1 picture of left cannot be read", "left/01.png", png(240, 180, [b"\0" * 240] * 20), kind="noted"),
    file_case("noise behind a PNG signature", r"1 picture of left cannot be read", "left/01.png", PNG_SIGNATURE + bytes(range(256)) * 8, kind="noted"),
    file_case("picture of another size", r"The pictures of left differ in size", "left/01.png", png(100, 90, [bytes(range(100))] * 90), kind="stored"),
    file_case("a black picture", r"left does not show the 9 x 6 target 'board' in 1 capture: 01\.", "left/01.png", png(240, 180, [b"\0" * 240] * 180), kind="noted"),
    file_case("picture that is text", r'file "left/01\.png": it is not a PNG picture', "left/01.png", b"hello, I am a picture\n" * 10),
    file_case("picture with the suffix of another", r'file "left/09\.jpg": it is a PNG picture, not a JPEG picture', "left/09.jpg", GOOD["left/01.png"]),
    file_case("unknown suffix", r'file "left/09\.gif": its name does not end in', "left/09.gif", b"GIF89a"),
    file_case("suffix in upper case", r'file "left/09\.PNG": its name does not end in', "left/09.PNG", GOOD["left/01.png"]),
    file_case("empty picture", r'file "left/01\.png": it is empty', "left/01.png", b""),
    file_case("cloud in the folder of a camera", r'file "left/09\.pcd": the path is not <sensor>/<capture>\.png', "left/09.pcd", pcd(FULL_WALL)),
    file_case("two files of one capture", r'file "left/01\.png": sensor \'left\' has another file of capture \'01\'', "left/01.jpg", b"\xff\xd8\xff\xe0" + b"\0" * 50),
    yaml_case("the same picture in both cameras", r"left and right have one and the same file in these captures, which are not used: 01, 02",
              kind="stored", files={"%s/%02d.png" % (side, k): GOOD["left/%02d.png" % k] for side in ("left", "right") for k in range(1, 7)}),
    yaml_case("all captures identical", r"left and right: 5 captures \(02, 03, 04, 05, 06\) repeat another",
              kind="stored", files={"%s/%02d.png" % (side, k): GOOD[side + "/01.png"] for side in ("left", "right") for k in range(1, 7)}),
]

UNREADABLE = r'1 cloud of lidar cannot be read and take no part: 01\. The first of them: file "'

CLOUDS = [
    cloud_case("truncated PCD", UNREADABLE + r'lidar/01\.pcd": its header announces 200 points of 12 bytes, but 2300 bytes follow', "pcd", pcd(FULL_WALL, data="binary")[:-100]),
    cloud_case("truncated PLY", UNREADABLE + r'lidar/01\.ply": its header announces 200 points of 12 bytes, but 2300 bytes follow', "ply", ply(FULL_WALL)[:-100]),
    file_case("truncated .bin", r'file "lidar/01\.bin": has 1593 bytes, which is no multiple of 16', "lidar/01.bin", struct.pack("<400f", *range(400))[:-7]),
    file_case(".bin of 5 floats a point", r'file "lidar/01\.bin": it is not certain to hold KITTI\'s 4 floats a point \(x y z intensity\): its numbers repeat every 5', "lidar/01.bin",
              b"".join(struct.pack("<5f", 5, y * 0.01 - 2, z * 0.1, 0.3, z) for y in range(400) for z in range(16))),
    cloud_case("PCD of 8e9 points", UNREADABLE + r'lidar/01\.pcd": its header announces 8000000000 points', "pcd", pcd(FULL_WALL, data="binary", width=8_000_000_000, count=8_000_000_000)),
    cloud_case("PCD whose POINTS is not WIDTH x HEIGHT", UNREADABLE + r'lidar/01\.pcd": POINTS 150 is not WIDTH times HEIGHT, 200', "pcd", pcd(FULL_WALL, count=150)),
    cloud_case("PCD without x", UNREADABLE + r'lidar/01\.pcd": field "x" is missing', "pcd", pcd(FULL_WALL, fields="a y z")),
    cloud_case("PCD of NaN only", UNREADABLE + r'lidar/01\.pcd": holds no point with finite coordinates', "pcd", pcd([(NAN, NAN, NAN)] * 200, data="binary")),
    cloud_case("PCD of infinities", UNREADABLE + r'lidar/01\.pcd": holds no point with finite coordinates', "pcd", pcd([(float("inf"),) * 3] * 200, data="binary")),
    cloud_case("PCD without points", UNREADABLE + r'lidar/01\.pcd": holds no point with finite coordinates', "pcd", pcd([])),
    cloud_case("compressed PCD with lying sizes", UNREADABLE + r'lidar/01\.pcd": its compressed body has 100 of 4000000000 bytes', "pcd", pcd(FULL_WALL, data="binary_compressed", body=struct.pack("<II", 4_000_000_000, 2400) + b"\x01" * 100)),
    cloud_case("compressed PCD of another size", UNREADABLE + r'lidar/01\.pcd": its compressed body claims to hold 4000000000 bytes', "pcd", pcd(FULL_WALL, data="binary_compressed", body=struct.pack("<II", 100, 4_000_000_000) + b"\x01" * 100)),
    cloud_case("ascii PCD with words", UNREADABLE + r'lidar/01\.pcd": line 12: "one" is not a number', "pcd", pcd(FULL_WALL, body=b"one two three\n" * 200)),
    cloud_case("PLY with a list in its vertex", UNREADABLE + r'lidar/01\.ply": property "i" of element "vertex" is a list', "ply", ply(FULL_WALL, properties="property float x\nproperty float y\nproperty float z\nproperty list uchar int i\n")),
    cloud_case("PLY of 4e18 points", UNREADABLE + r'lidar/01\.ply": its header announces 4000000000000000000 points', "ply", ply(FULL_WALL, count=4 * 10**18)),
    cloud_case("PLY without an end of its header", UNREADABLE + r'lidar/01\.ply": its header has no end_header line', "ply", b"ply\nformat ascii 1.0\nelement vertex 3\n" + b"comment x\n" * 1000),
    cloud_case("a cloud without a board", r"lidar does not show target 'board' in 1 capture: 01\. The first of them: no flat patch of 0\.30 x 0\.20 m", "pcd", pcd(FULL_WALL)),
    file_case("picture in the folder of a lidar", r'file "lidar/01\.png": the path is not <sensor>/<capture>\.pcd, \.ply or \.bin', "lidar/01.png", GOOD["left/01.png"]),
    file_case("empty cloud", r'file "lidar/01\.pcd": it is empty', "lidar/01.pcd", b""),
    file_case("PLY called PCD", r'file "lidar/01\.pcd": it is a PLY cloud, not a PCD cloud', "lidar/01.pcd", ply(FULL_WALL)),
]

INTRINSICS = "    intrinsics: {fx_px: 260.0, fy_px: 260.0, cx_px: 119.5, cy_px: 89.5}\n"
BOARD = "  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}\n"
CHARUCO = "  board: {type: charuco, squares: [9, 6], square_size_m: 0.025, marker_size_m: 0.018, dictionary: DICT_4X4_50}\n"


SESSIONS = [
    yaml_case("a session without captures", r"session folder .*: it has no captures", files={}),
    yaml_case("a session without targets", r"session\.yaml line \d+: targets: the session has 0", ("targets:\n" + BOARD, "targets: {}\n")),
    yaml_case("targets left out", r'session\.yaml line \d+: "targets" is missing', ("targets:\n" + BOARD, "")),
    yaml_case("sensors without entries", r"session\.yaml line \d+: sensors: the session has 0", (YAML[YAML.index("sensors:"):], "sensors: {}\n")),
    yaml_case("a sensor without pictures", r"left and right see the board together in no capture", kind="stored",
              files={path: content for path, content in GOOD.items() if path.startswith("left")}),
    yaml_case("wrong counts of the board", r"left does not show the 8 x 5 target 'board' in 6 captures", ("[9, 6]", "[8, 5]"), kind="stored", files=GOOD),
    yaml_case("one inner corner", r"session\.yaml line \d+: target board: 1x6 inner corners is out of range", ("[9, 6]", "[1, 6]")),
    yaml_case("corners of a million", r"session\.yaml line \d+: target 'board': inner_corners: must be a whole number from 1 to 1000", ("[9, 6]", "[1000000, 6]")),
    yaml_case("squares of 25 m", r"session\.yaml line \d+: target board: square_size_m 25\.0+ is out of range", ("0.025", "25")),
    yaml_case("squares below zero", r"session\.yaml line \d+: target board: square_size_m -0\.025.* is out of range", ("0.025", "-0.025")),
    yaml_case("squares that are no number", r"session\.yaml line \d+: target 'board': square_size_m: must be a number", ("0.025", "nan")),
    yaml_case("sigma of the squares above their size", r"session\.yaml line \d+: target board: the standard deviation", ("0.025}", "0.025, square_size_sigma_m: 1.0}")),
    yaml_case("plate smaller than the pattern", r"session\.yaml line \d+: target board: plate_size_m 0\.1.* does not fit its pattern", ("0.025}", "0.025, plate_size_m: [0.1, 0.1]}")),
    yaml_case("marker larger than its square", r"session\.yaml line \d+: target board: marker_size_m 0\.03.* is out of range", (BOARD, CHARUCO), ("0.018", "0.03")),
    yaml_case("unknown dictionary", r'session\.yaml line \d+: target board: dictionary "DICT_9X9_9" is not known', (BOARD, CHARUCO), ("DICT_4X4_50", "DICT_9X9_9")),
    yaml_case("unknown kind of target", r'session\.yaml line \d+: target .board.: type: is not known here', ("checkerboard", "chessboard")),
    yaml_case("unknown sensor in reference", r'session\.yaml line 4: reference sensor "middle" is not a sensor', ("reference: left", "reference: middle")),
    yaml_case("unknown target in sees", r'session\.yaml line \d+: sensor left: it sees target "plank"', ("sees: board", "sees: plank")),
    yaml_case("unknown key", r'session\.yaml line \d+: sensor .left.: unknown key "tpye"; did you mean "type"', ("    type: camera\n    sees", "    type: camera\n    tpye: camera\n    sees")),
    yaml_case("sensor twice", r'session\.yaml line \d+: "left" stands twice', ("  right:", "  left:")),
    yaml_case("two sensors that differ in case only", r"session\.yaml line \d+: sensor LEFT differs from left only in case", ("  right:", "  LEFT:")),
    yaml_case("tracker with a target", r"session\.yaml line \d+: sensor .?right.?: a tracker sees no target", ("  right:\n    type: camera\n    sees: board\n" + INTRINSICS, "  right: {type: tracker, sees: board}\n")),
    yaml_case("pose of an unknown capture", r"right/poses\.csv line 2: no other sensor has a capture 99", ("  right:\n    type: camera\n    sees: board\n" + INTRINSICS, "  right: {type: tracker}\n"),
              files={"left/01.png": GOOD["left/01.png"], "right/poses.csv": b"capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n99,0,0,0,0,0,0,0,1\n"}),
    yaml_case("skipped pair of an unknown sensor", r"session\.yaml line \d+: skip_pairs: \[left, up\]: .up. is not a sensor", ("reference: left", "reference: left\nskip_pairs: [[left, up]]")),
    yaml_case("polish that there is not", r"session\.yaml line \d+: lidar_polish: polish .point_to_plane. is not known", ("reference: left", "reference: left\nlidar_polish: point_to_plane")),
    yaml_case("polish without two lidars", r"session\.yaml line \d+: lidar_polish: the session has no two lidars", ("reference: left", "reference: left\nlidar_polish: gicp")),
    yaml_case("lidar with intrinsics", r"session\.yaml line \d+: sensor .?left.?: a lidar has no intrinsics", ("  left:\n    type: camera", "  left:\n    type: lidar")),
    yaml_case("folder of no sensor", r'folder "middle": session\.yaml has no sensor of this name', files={**few(), "middle/01.png": GOOD["left/01.png"]}),
    yaml_case("focal length of zero", r"session\.yaml line \d+: sensor .?left.?: intrinsics: a focal length is not positive", ("fx_px: 260.0", "fx_px: 0")),
    yaml_case("negative focal length", r"session\.yaml line \d+: sensor .?left.?: intrinsics: a focal length is not positive", ("fy_px: 260.0", "fy_px: -260")),
    yaml_case("focal length that is no number", r"session\.yaml line \d+: sensor .?left.?: intrinsics: fx_px: must be a number", ("fx_px: 260.0", "fx_px: .nan")),
    yaml_case("focal length of 1e308", r"session\.yaml line \d+: sensor .?left.?: intrinsics: a value is beyond a million pixels", ("fx_px: 260.0", "fx_px: 1e308")),
    yaml_case("too few coefficients of distortion", r"session\.yaml line \d+: sensor .?left.?: intrinsics: distortion: must be a list of 5 numbers; it has 3", ("cy_px: 89.5}", "cy_px: 89.5, distortion: [0, 0, 0]}")),
    yaml_case("unknown model of camera", r"session\.yaml line \d+: sensor .?left.?: intrinsics: model: is not known here", ("cy_px: 89.5}", "cy_px: 89.5, model: pinhole_magic}")),
    yaml_case("sigma of intrinsics below zero", r"session\.yaml line \d+: sensor .?left.?: intrinsics: sigma is not 9 finite numbers", ("cy_px: 89.5}", "cy_px: 89.5, sigma: [-1, 0, 0, 0, 0, 0, 0, 0, 0]}")),
    nominal_case("nominal position that is no number", r"session\.yaml line \d+: sensor .right.: T_ref_nominal: p_m: must be a number", "[.nan, 0, 0]", "[0, 0, 0, 1]"),
    nominal_case("nominal position without end", r"session\.yaml line \d+: sensor .right.: T_ref_nominal: p_m: must be a number", "[inf, 0, 0]", "[0, 0, 0, 1]"),
    nominal_case("nominal position of 1e308 m", r"session\.yaml line \d+: sensor .?right.?: nominal p_m holds 1e\+308 m", "[1e308, 0, 0]", "[0, 0, 0, 1]"),
    nominal_case("nominal quaternion that is not unit", r"session\.yaml line \d+: sensor .right.: T_ref_nominal: q_xyzw: must have unit length \(it is 2", "[0, 0, 0]", "[0, 0, 0, 2]"),
    nominal_case("nominal quaternion of zeros", r"session\.yaml line \d+: sensor .right.: T_ref_nominal: q_xyzw: must have unit length \(it is 0", "[0, 0, 0]", "[0, 0, 0, 0]"),
    nominal_case("nominal quaternion of 1e308", r"session\.yaml line \d+: sensor .right.: T_ref_nominal: q_xyzw: must have unit length", "[0, 0, 0]", "[1e308, 0, 0, 1]"),
    yaml_case("captured tomorrow and later", r"captured_at 2190-01-01T00:00:00Z is more than a day ahead of this server's clock, 20\d\d-", ("2026-01-31T12:00:00Z", "2190-01-01T00:00:00Z")),
    yaml_case("captured before 1970", r'session\.yaml line 3: captured_at: time "1969-12-31T23:59:59Z" is not a date between 1970 and 2200', ("2026-01-31T12:00:00Z", "1969-12-31T23:59:59Z")),
    yaml_case("captured on 30 February", r'session\.yaml line 3: captured_at: time "2026-02-30T12:00:00Z" is not a date', ("2026-01-31T12:00:00Z", "2026-02-30T12:00:00Z")),
    yaml_case("format of the future", r"session\.yaml line 1: format: must be a whole number from 1 to 1", ("format: 1", "format: 2")),
]

YAML_BYTES = [
    yaml_case("aliases that multiply", r"session\.yaml line \d+: anchors and aliases", ("sensors:", "conditions: {a: &a [x, x], b: &b [*a, *a], c: [*b, *b]}\nsensors:")),
    raw_yaml_case("1000 levels deep", r"session\.yaml line \d+: nested deeper than", b"format: " + b"[" * 1000 + b"]" * 1000),
    raw_yaml_case("100,000 levels deep", r"session\.yaml line 1: nested deeper than 8 levels", b"format: " + b"{a: " * 100_000),
    raw_yaml_case("2 MiB of YAML", r".*session\.yaml is larger than 1048576 bytes", b"# " + b"x" * (2 << 20)),
    yaml_case("a tag", r"session\.yaml line 1: tags are not used here", ("format: 1", "format: !!int 1")),
    yaml_case("a key twice", r'session\.yaml line 2: "format" stands twice \(first in line 1\)', ("format: 1\n", "format: 1\nformat: 1\n")),
    raw_yaml_case("text that is not UTF-8", r"session\.yaml line 2: is not UTF-8 text", b"format: 1\nrobot: \xff\xfe\n"),
    raw_yaml_case("bytes of zero", r"session\.yaml line 1: is not UTF-8 text", b"format: 1\0\n"),
    raw_yaml_case("tabs for indentation", r"session\.yaml line \d+: not YAML", b"format: 1\nsensors:\n\tleft: {type: camera}\n"),
    raw_yaml_case("an empty session.yaml", r"session\.yaml line 1: must be a map", b""),
    raw_yaml_case("two documents", r"session\.yaml line \d+: a second document begins", YAML.replace("ROBOT", "two").encode() + b"---\nformat: 1\n"),
    raw_yaml_case("nothing but bytes of zero", r"session\.yaml line 1: is not UTF-8 text", b"\x00" * 100),
    yaml_case("robot of 10,000 characters", r'session\.yaml line 2: robot: robot id "x{80}\.\.\." is not a valid name', ("ROBOT", LONG)),
    yaml_case("robot ../x", r'session\.yaml line 2: robot: robot id "\.\./x" is not a valid name', ("ROBOT", "../x")),
    yaml_case("robot that is a folder", r'session\.yaml line 2: robot: robot id "a/b" is not a valid name', ("ROBOT", "a/b")),
    yaml_case("sensor ../x", r'session\.yaml line \d+: sensor id "\.\./x" is not a valid name', ("  right:", '  "../x":')),
    yaml_case("sensor of 1,000 characters", r'session\.yaml line \d+: sensor id "x{80}\.\.\." is not a valid name', ("  right:", "  %s:" % LONG[:1000])),
    yaml_case("target ../x", r'session\.yaml line \d+: target id "\.\./x" is not a valid name', ("  board:", '  "../x":'), ("sees: board", 'sees: "../x"'), ("sees: board", 'sees: "../x"')),
    yaml_case("operator with control characters", r"session\.yaml line 5: text has control characters", ("reference: left", 'reference: left\noperator: "\\x1b[2J"')),
]


def make_long_name(folder):
    (folder / "left" / ("x" * 200 + ".png")).write_bytes(GOOD["left/01.png"])


def make_fifo(folder):
    (folder / "left" / "09.png").unlink(missing_ok=True)
    os.mkfifo(folder / "left" / "09.png")


def make_loop(folder):
    (folder / "left" / "09.png").symlink_to("10.png")
    (folder / "left" / "10.png").symlink_to("09.png")


def make_yaml_fifo(folder):
    (folder / "session.yaml").unlink()
    os.mkfifo(folder / "session.yaml")


def make_yaml_folder(folder):
    (folder / "session.yaml").unlink()
    (folder / "session.yaml").mkdir()


FILES = [
    folder_case("capture with a name of 200 characters", r'file "left/x+\.\.\.": capture id "x{80}\.\.\." is not a valid name', make_long_name),
    folder_case("capture ..x", r'file "left/-\.\.x\.png": capture id "-\.\.x" is not a valid name', lambda folder: (folder / "left" / "-..x.png").write_bytes(GOOD["left/01.png"])),
    folder_case("file name with a line end", r'file "left/a\\x0ab\.png": capture id "a\\x0ab" is not a valid name', lambda folder: (folder / "left" / "a\nb.png").write_bytes(GOOD["left/01.png"])),
    folder_case("file name that is not UTF-8", r'file "left/\\xff\.png": capture id "\\xff" is not a valid name',
                lambda folder: open(os.fsencode(folder) + b"/left/\xff.png", "wb").write(GOOD["left/01.png"])),
    folder_case("link out of the folder", r'file "left/09\.png": the symbolic link leads out of the session', lambda folder: (folder / "left" / "09.png").symlink_to("/etc/hostname")),
    folder_case("link to nowhere", r'file "left/09\.png": the symbolic link leads nowhere', lambda folder: (folder / "left" / "09.png").symlink_to("nothing.png")),
    folder_case("links in a circle", r'file "left/(09|10)\.png": the symbolic link leads nowhere', make_loop),
    folder_case("folder that links out", r'file "middle": the symbolic link leads out of the session', lambda folder: (folder / "middle").symlink_to("/etc")),
    folder_case("session.yaml that links out", r'file "session\.yaml": the symbolic link leads out of the session', lambda folder: ((folder / "session.yaml").unlink(), (folder / "session.yaml").symlink_to("/etc/hostname"))),
    folder_case("pipe for a picture", r'file "left/09\.png": it is not a file', make_fifo),
    folder_case("pipe for session.yaml", r".*session\.yaml is not a regular file", make_yaml_fifo),
    folder_case("folder for session.yaml", r".*session\.yaml is not a regular file", make_yaml_folder),
    folder_case("folder for a picture", r'file "left/09\.png": it is not a file', lambda folder: (folder / "left" / "09.png").mkdir()),
    folder_case("file for a sensor's folder", r'file "notes\.txt": it does not belong to a session', lambda folder: (folder / "notes.txt").write_text("x")),
    folder_case("no session.yaml", r"session folder .*: it has no session\.yaml", lambda folder: (folder / "session.yaml").unlink()),
]

EDGES = [
    edges_case("position NaN", r"edge file: line 1: not JSON", json.dumps({"format": 1, "edges": [edge()]}).replace("1.0, 0.0, 0.0], \"q", "NaN, 0.0, 0.0], \"q")),
    edges_case("position without end", r"edge file: line 1: a number is too large", json.dumps({"format": 1, "edges": [edge()]}).replace("1.0, 0.0, 0.0], \"q", "1e999, 0.0, 0.0], \"q")),
    pose_case("position of 1e308 m", r"edge file: edges\[0\]: edge a - b: p_m holds 1e\+308 m", p_m=(1e308, 0, 0)),
    pose_case("position of 2,000 km", r"edge file: edges\[0\]: edge a - b: p_m holds 2e\+06 m", p_m=(0, -2e6, 0)),
    pose_case("quaternion of length 2", r"edge file: edges\[0\]\.T_a_b\.q_xyzw: must have unit length \(it is 2", q_xyzw=(0, 0, 0, 2)),
    pose_case("quaternion of zeros", r"edge file: edges\[0\]\.T_a_b\.q_xyzw: must have unit length \(it is 0", q_xyzw=(0, 0, 0, 0)),
    pose_case("quaternion of 3 numbers", r"edge file: edges\[0\]\.T_a_b\.q_xyzw: ", q_xyzw=(0, 0, 0)),
    edges_case("asymmetric information", r"edge file: edges\[0\]\.information: is not symmetric: \[0\]\[1\] is 5", [edge(information=with_entry(0, 1, 5.0))]),
    edges_case("indefinite information", r"edge file: edges\[0\]\.information: has a negative eigenvalue", [edge(information=with_entry(2, 2, -1.0))]),
    edges_case("information NaN", r"edge file: line 1: not JSON", json.dumps({"format": 1, "edges": [edge(information=with_entry(0, 0, NAN))]})),
    edges_case("information of zeros", r"edge file: edges\[0\]\.information: is zero: it says nothing", [edge(information=[[0.0] * 6] * 6)]),
    edges_case("information of 1e308", r"edge file: edges\[0\].*information", [edge(information=with_entry(0, 0, 1e308))]),
    edges_case("information of 1e19", r"edge file: edges\[0\].*information holds 1e\+19", [edge(information=with_entry(0, 0, 1e19))]),
    edges_case("information of 5 rows", r"edge file: edges\[0\]\.information: must be 6 rows of 6 numbers", [edge(information=IDENTITY[:5])]),
    edges_case("information of 7 columns", r"edge file: edges\[0\]\.information", [edge(information=[row + [0.0] for row in IDENTITY])]),
    edges_case("singular covariance", r"edge file: edges\[0\]\.covariance: is not positive definite", [{key: value for key, value in edge(covariance=[[0.0] * 6] * 6).items() if key != "information"}]),
    edges_case("information and covariance", r'edge file: edges\[0\]: has both "information" and "covariance"', [edge(covariance=IDENTITY)]),
    edges_case("an edge from a sensor to itself", r"edge file: edges\[0\]: .*frame_a and frame_b are the same", [edge(frame_b="a")]),
    edges_case("sensor ../x in an edge", r'edge file: edges\[0\]\.frame_a: .*"\.\./x" is not a valid name', [edge(frame_a="../x")]),
    edges_case("sensor of 10,000 characters in an edge", r"edge file: edges\[0\]\.frame_a: has 10000 bytes; the limit is", [edge(frame_a=LONG)]),
    edges_case("unknown field of an edge", r'edge file: edges\[0\]: unknown field "T_a_b_m"', [edge(T_a_b_m=1)]),
    edges_case("one block of a jackknife", r"edge file: edges\[0\]: .*blocks: a jackknife uncertainty has 1 block", [edge(source="jackknife", blocks=[{"block_id": "01", "d": [0] * 6}])]),
    edges_case("no edges", r'edge file: "edges" is empty', []),
    edges_case("JSON of depth 1000", r"edge file: nested deeper than 32 levels", '{"format": 1, "edges": ' + "[" * 1000 + "]" * 1000 + "}"),
    edges_case("JSON with a key twice", r'edge file: "format" stands twice', '{"format": 1, "format": 1, "edges": []}'),
    edges_case("JSON with a string of 100 MB", r"edge file: edges\[0\]\.frame_a: has 100000000 bytes; the limit is", lambda: b'{"format": 1, "edges": [{"frame_a": "' + b"x" * 100_000_000 + b'"}]}'),
    edges_case("JSON cut off", r"edge file: line 1: not JSON", '{"format": 1, "edges": [{"frame_a": "a"'),
    edges_case("JSON that is not UTF-8", r"edge file: line 1: not JSON", b'{"format": 1, "edges": [{"frame_a": "\xff"}]}'),
    g2o_case("g2o with an indefinite matrix", r"line 1: edge 0 - 1: the information matrix is indefinite", "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 -" + UPPER + "\n"),
    g2o_case("g2o with NaN", r'line 1: edge 0 - 1: "nan" is not a finite number', "EDGE_SE3:QUAT 0 1 nan 0 0 0 0 0 1 " + UPPER + "\n"),
    g2o_case("g2o with fields missing", r"line 1: edge 0 - 1: ends after 10 of 28 numbers", "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0\n"),
    g2o_case("g2o with a quaternion that is not unit", r"line 1: edge 0 - 1: the quaternion has length 3", "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 3 " + UPPER + "\n"),
    g2o_case("g2o with a vertex twice", r"line 2: vertex 0: occurs twice", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n" + G2O_EDGE),
    g2o_case("g2o without edges", r"the file has no EDGE_SE3:QUAT line", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"),
    g2o_case("g2o with a vertex of letters", r'line 1: "a/\.\./b" is not a vertex number', "EDGE_SE3:QUAT a/../b 1 1 0 0 0 0 0 1 " + UPPER + "\n"),
    g2o_case("g2o with a position of 1e300", r"line 1: edge 0 - 1: p_m holds 1e\+300 m", "EDGE_SE3:QUAT 0 1 1e300 0 0 0 0 0 1 " + UPPER + "\n"),
]

WIRE = [
    wire_case("foreign-robot", r'refused: robot wire-b: its data came from partition "robot/wire-a"'),
    wire_case("stranger-chunk", r"refused: session [0-9a-f]{64} belongs to robot"),
    wire_case("stranger-session", r"refused: session [0-9a-f]{64} belongs to robot"),
    wire_case("unknown-session-chunk", r"need_manifest: "),
    wire_case("chunk-outside", r"receiving: a chunk at byte \d+ of payload \d+ lies outside"),
    wire_case("huge-chunk", r"refused: chunk of \d+ bytes"),
    wire_case("disorder", r"closed: same digest"),
    wire_case("wrong-hash", r"receiving: front/100000\.png: its bytes do not have the hash"),
    wire_case("beyond-window", r"busy: \d+ chunks; closed"),
    wire_case("manifest-traversal", r'refused: manifest: payloads\[0\]\.path: file "\.\./\.\./etc/x\.png": it is not in'),
    wire_case("manifest-hash", r"refused: the manifest of session [0-9a-f]{64} has another hash"),
    wire_case("manifest-garbage", r"refused: manifest: line 1: not JSON"),
    wire_case("manifest-future", r"refused: captured_at 2190-01-01"),
    wire_case("future-protocol", r"refused: the client speaks protocol 4000000000"),
    wire_case("request-malformed", r"error: the request's parameters are not a JSON object"),
    wire_case("request-10MB", r"error: a request of \d+ bytes"),
    wire_case("request-verb", r"error: the verb 'no-such-verb' is not known"),
    wire_case("request-not-utf8", r"error: the request's parameters are not a JSON object"),
    wire_case("edge-nan", r"refused: edge 0 \(left - right\): p_m holds a value that is not a number"),
    wire_case("edge-foreign", r'refused: robot wire-b: its data came from partition "robot/wire-a"'),
    wire_case("edge-not-utf8", r'refused: sensor id "\\xffeft" is not a valid name'),
    wire_case("edge-id", r"refused: edge 0 \(left - right\): its id is not that of its content"),
    wire_case("edge-index", r"refused: edge 7 \(left - right\): item 7 of a batch of 1"),
    wire_case("edge-absurd", r"refused: edge left - right: p_m holds 1e\+300 m"),
]

CASES = PICTURES + CLOUDS + SESSIONS + YAML_BYTES + FILES + EDGES + WIRE
