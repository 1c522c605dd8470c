"""Session folders made for measuring: pictures of exact sizes whose content is noise behind a PNG signature."""
import pathlib
import random

HEADER = """format: 1
robot: %s
captured_at: 2026-01-31T12:00:00Z
reference: left
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}
sensors:
  left: {type: camera, sees: board}
  right: {type: camera, sees: board}
"""
PNG_START = bytes.fromhex("89504e470d0a1a0a0000000d49484452")


def noise_session(folder, robot, payload_bytes, count, seed):
    """`count` payloads of `payload_bytes` each: bytes that no compressor and no cache of contents can shorten."""
    folder = pathlib.Path(folder)
    (folder / "left").mkdir(parents=True)
    (folder / "right").mkdir()
    (folder / "session.yaml").write_text(HEADER % robot)
    noise = random.Random(seed)
    for idx in range(count):
        side = "left" if idx % 2 == 0 else "right"
        (folder / side / ("%05d.png" % (idx // 2))).write_bytes(PNG_START + noise.randbytes(payload_bytes - len(PNG_START)))
    return folder


def padded_session(folder, robot, pictures, payload_bytes, count, seed):
    """`count` payloads of `payload_bytes`: real pictures that decode, each made unique by noise behind its end."""
    noise_session(folder, robot, len(PNG_START), 0, seed)
    noise = random.Random(seed)
    real = {side: sorted(pathlib.Path(pictures).glob(side + "[0-9][0-9].jpg")) for side in ("left", "right")}
    for idx in range(count):
        side = "left" if idx % 2 == 0 else "right"
        picture = real[side][idx // 2 % len(real[side])].read_bytes()
        (pathlib.Path(folder) / side / ("%05d.jpg" % (idx // 2))).write_bytes(picture + noise.randbytes(payload_bytes - len(picture)))
    return pathlib.Path(folder)


def add_noise(session, payload_bytes, count, seed):
    """More payloads in a session: files that take their time on the way and hold no board."""
    noise = random.Random(seed)
    for idx in range(count):
        side = "left" if idx % 2 == 0 else "right"
        (session / side / ("noise%03d.png" % (idx // 2))).write_bytes(PNG_START + noise.randbytes(payload_bytes - len(PNG_START)))


def picture_session(folder, robot, pictures):
    """The real stereo pairs as a session folder."""
    folder = pathlib.Path(folder)
    for side in ("left", "right"):
        (folder / side).mkdir(parents=True)
        for picture in sorted(pathlib.Path(pictures).glob(side + "[0-9][0-9].jpg")):
            (folder / side / (picture.stem[len(side):] + ".jpg")).write_bytes(picture.read_bytes())
    (folder / "session.yaml").write_text(HEADER % robot)
    return folder
