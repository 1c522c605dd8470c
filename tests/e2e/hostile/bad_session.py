"""A small good session without any data set: a board drawn as two cameras see it, and files of a lidar, byte by byte."""
import math
import struct
import zlib

WIDTH_PX, HEIGHT_PX, FOCAL_PX = 240, 180, 260.0
SQUARE_M, COLUMNS, ROWS, BASELINE_M = 0.025, 9, 6, 0.04
CAPTURES = 6

YAML = """format: 1
robot: ROBOT
captured_at: 2026-01-31T12:00:00Z
reference: left
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  left:
    type: camera
    sees: board
    intrinsics: {fx_px: 260.0, fy_px: 260.0, cx_px: 119.5, cy_px: 89.5}
  right:
    type: camera
    sees: board
    intrinsics: {fx_px: 260.0, fy_px: 260.0, cx_px: 119.5, cy_px: 89.5}
"""
LIDAR_YAML = """format: 1
robot: ROBOT
captured_at: 2026-01-31T12:00:00Z
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025, plate_size_m: [0.3, 0.2]}
sensors:
  left: {type: camera}
  lidar: {type: lidar}
"""


def chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png(width, height, rows):
    """8 bit grey. `rows`: bytes of each row; what the header claims need not be true."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def rotation(x, y):
    """About x, then about y."""
    cx, sx, cy, sy = math.cos(x), math.sin(x), math.cos(y), math.sin(y)
    return ((cy, sx * sy, cx * sy), (0.0, cx, -sx), (-sy, sx * cy, cx * cy))


def board_picture(camera_x_m, tilt_x, tilt_y, shift_m):
    """The board as a camera at camera_x_m sees it: each ray meets the plane of the board, whose squares follow from signs."""
    turn = rotation(tilt_x, tilt_y)
    centre = (shift_m[0] - camera_x_m, shift_m[1], shift_m[2])
    columns = [tuple(turn[row][axis] for row in range(3)) for axis in range(3)]
    distance = sum(columns[2][k] * centre[k] for k in range(3))
    along = [sum(columns[axis][k] * centre[k] for k in range(3)) for axis in range(2)]
    half = ((COLUMNS + 1) / 2, (ROWS + 1) / 2)
    rows = []
    for v in range(HEIGHT_PX):
        row = bytearray(b"\xc8" * WIDTH_PX)
        for u in range(WIDTH_PX):
            ray = ((u - (WIDTH_PX - 1) / 2) / FOCAL_PX, (v - (HEIGHT_PX - 1) / 2) / FOCAL_PX, 1.0)
            depth = distance / (columns[2][0] * ray[0] + columns[2][1] * ray[1] + columns[2][2])
            a = (depth * (columns[0][0] * ray[0] + columns[0][1] * ray[1] + columns[0][2]) - along[0]) / SQUARE_M + half[0]
            b = (depth * (columns[1][0] * ray[0] + columns[1][1] * ray[1] + columns[1][2]) - along[1]) / SQUARE_M + half[1]
            if 0 <= a <= COLUMNS + 1 and 0 <= b <= ROWS + 1:
                sign = math.sin(math.pi * a) * math.sin(math.pi * b)
                row[u] = int(125 - 95 * max(-1.0, min(1.0, 6 * sign)))
        rows.append(bytes(row))
    return png(WIDTH_PX, HEIGHT_PX, rows)


def pictures():
    """{"left/01.png": bytes, ...}: CAPTURES pairs of one board, tilted differently."""
    poses = [(0.0, 0.35, (0.02, 0.0, 0.40)), (0.35, 0.0, (0.02, 0.01, 0.42)), (-0.35, 0.1, (0.03, -0.01, 0.40)),
             (0.1, -0.4, (0.01, 0.0, 0.41)), (0.25, 0.3, (0.02, 0.01, 0.45)), (-0.3, -0.3, (0.02, -0.01, 0.44))]
    made = {}
    for index, (tilt_x, tilt_y, shift_m) in enumerate(poses):
        for side, camera_x_m in (("left", 0.0), ("right", BASELINE_M)):
            made["%s/%02d.png" % (side, index + 1)] = board_picture(camera_x_m, tilt_x, tilt_y, shift_m)
    return made


def pcd(points, fields="x y z", data="ascii", width=None, height=1, count=None, body=None):
    """A PCD whose header may lie: `width`, `count` (POINTS) and `body` replace what follows from the points."""
    names = fields.split()
    header = "# .PCD v0.7\nVERSION 0.7\nFIELDS %s\nSIZE %s\nTYPE %s\nCOUNT %s\nWIDTH %d\nHEIGHT %d\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA %s\n" % (
        fields, " ".join("4" for _ in names), " ".join("F" for _ in names), " ".join("1" for _ in names),
        len(points) if width is None else width, height, len(points) if count is None else count, data)
    if body is None:
        body = "".join(" ".join(map(str, point)) + "\n" for point in points).encode() if data == "ascii" else floats(points)
    return header.encode() + body


def ply(points, count=None, properties="property float x\nproperty float y\nproperty float z\n", body=None):
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" % (len(points) if count is None else count, properties)
    return header.encode() + (floats(points) if body is None else body)


def floats(points):
    return b"".join(struct.pack("<%df" % len(point), *point) for point in points)


def points(count=200):
    """A wall 3 m ahead: a good cloud without a board."""
    return [(3.0, 0.05 * (index % 20) - 0.5, 0.05 * (index // 20) - 0.25) for index in range(count)]
