"""Large bags of one camera, made quickly: JPEG files of a given size with holes for most of their bytes, and raw pictures with noise."""
import random
import struct

from . import writer

START_NS, PERIOD_NS = 1_700_000_000_000_000_000, 100_000_000
RIG = """format: 1
robot: large-bag
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  front: {type: camera, topic: /front, sees: board}
"""


def begin(file, kind):
    topic = b"/front"
    file.write(b"\x89MCAP0\r\n" + writer.record(1, writer.block32(b"ros2") + writer.block32(b"")))
    file.write(writer.record(3, struct.pack("<H", 1) + writer.block32(kind.replace("/", "/msg/").encode()) + writer.block32(b"ros2msg")
                             + writer.block32(writer.definition(kind, 2).encode())))
    file.write(writer.record(4, struct.pack("<HH", 0, 1) + writer.block32(topic) + writer.block32(b"cdr") + writer.block32(b"")))


def end(file):
    file.write(writer.record(15, struct.pack("<I", 0)) + writer.record(2, struct.pack("<QQI", 0, 0, 0)) + b"\x89MCAP0\r\n")


def message_head(index, message_bytes):
    stamp_ns = START_NS + index * PERIOD_NS
    return struct.pack("<BQHIQQ", 5, 22 + message_bytes, 0, index, stamp_ns, stamp_ns)


def of_jpeg(path, count, jpeg_bytes):
    """`count` messages whose JPEG files are a signature and zeros: the bag has holes there, the session's files have not."""
    with open(path, "wb") as file:
        begin(file, "sensor_msgs/CompressedImage")
        for index in range(count):
            front = writer.compressed("cdr", START_NS + index * PERIOD_NS, "jpeg", b"\xff\xd8\xff\xe0")
            front = front[:-8] + struct.pack("<I", jpeg_bytes) + front[-4:]  # the length of what follows with its hole
            file.write(message_head(index, len(front) - 4 + jpeg_bytes) + front)
            file.seek(jpeg_bytes - 4, 1)
        end(file)


def noisy_pixels(width, height):
    """Grey, with 4 bits of noise: about as hard to pack as a camera's picture."""
    return random.Random(1).randbytes(width * height).translate(bytes(100 + value % 16 for value in range(256)))


def of_pixels(path, count, width, height, pixels):
    with open(path, "wb") as file:
        begin(file, "sensor_msgs/Image")
        for index in range(count):
            message = writer.image("cdr", START_NS + index * PERIOD_NS, width, height, "mono8", pixels, width)
            file.write(message_head(index, len(message)) + message)
        end(file)
