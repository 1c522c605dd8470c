"""A made coloured cloud and overlay in a published report."""
import os
import random
import struct

PIXEL = bytes.fromhex("89504e470d0a1a0a0000000d49484452000000010000000108060000001f15c4890000000d49444154789c6360f8cf500f00038301"
                      "80b5d7a5fc0000000049454e44ae426082")
SECTION = """<section class="card"><h2>Coloured clouds</h2>
<p class="hint"><a href="cloud/top/cloud.ply">The cloud as PLY</a></p><p class="hint"><a href="cloud/base/cloud.ply">The cloud as PLY</a></p>
<figure><a href="overlay/front.jpg"><img src="overlay/front.jpg" alt="top in the picture of front"></a>
<figcaption>front (<a href="overlay/front_picture.jpg">picture alone</a>)</figcaption></figure></section>"""


def records(count, seed):
    """Points of a box of 20 m; a thousand different ones, again and again: what costs is their number."""
    draw = random.Random(seed)
    one = [struct.pack("<hhhBBBBBB", draw.randint(-10000, 10000), draw.randint(-10000, 10000), draw.randint(-1500, 1500), draw.randrange(256),
                       draw.randrange(256), draw.randrange(256), draw.choice([0, 1, 2, 255]), draw.randrange(256), 0) for _ in range(min(count, 1000))]
    return b"".join(one) * (count // len(one))


def write_cloud(folder, count):
    (folder / "overlay").mkdir()
    for lidar, points in (("top", count), ("base", 1000)):
        place = folder / "cloud" / lidar
        place.mkdir(parents=True)
        (place / "points.bin").write_bytes(b"RCLD" + struct.pack("<II4f", 1, points, 1.0, 2.0, 3.0, 0.001) + records(points, 5))
        (place / "cloud.ply").write_bytes(b"ply\n")
    for name in ("front.jpg", "front_picture.jpg"):
        (folder / "overlay" / name).write_bytes(PIXEL)
    page = folder / "index.html"
    text = page.read_text().replace("</main>", SECTION + "</main>")
    os.unlink(page)
    page.write_text(text)
