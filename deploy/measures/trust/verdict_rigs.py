"""Small robots whose visits are drawn, a server that they are pushed to, and what it says of them."""
import datetime
import json
import pathlib
import re
import subprocess
import sys
import zlib

E2E = pathlib.Path(__file__).resolve().parents[3] / "tests" / "e2e"
sys.path[:0] = [str(E2E / "hostile"), str(E2E)]
from front_rig import THIRD  # noqa: E402  a third camera to the front

FRONT = ("front_left", "front_right", "front_top")
BODY = FRONT + ("body",)
BLOCK = r"(?m)^  (\w+):.*\n(?:    .*\n)*"  # of one sensor, or one board


def ago(days):
    """Time as session.yaml has it; noon, so that nothing depends on the hour of the measure."""
    noon = datetime.datetime.now(datetime.timezone.utc).replace(hour=12, minute=0, second=0, microsecond=0)
    return (noon - datetime.timedelta(days=days)).strftime("%Y-%m-%dT%H:%M:%SZ")


def blocks(text):
    return {found.group(1): found.group(0) for found in re.finditer(BLOCK, text)}


def changed(text, changes):
    for old, new in changes:
        if text.count(old) != 1:
            raise RuntimeError("%d times instead of once: %s" % (text.count(old), old))
        text = text.replace(old, new)
    return text


class Mapper:
    """The MARS Mapper and one camera more, of which a rig is a part."""

    def __init__(self, text):
        self.head, rest = text.split("\nboards:\n")
        boards, rest = rest.split("\n\n", 1)
        self.room, sensors = rest.split("\nsensors:\n")
        self.boards, self.sensors = blocks(boards + "\n"), {**blocks(sensors.split("\n#")[0] + "\n"), **blocks(THIRD)}

    def seen(self, sensors):
        return [board for board in self.boards if any("sees: %s," % board in self.sensors[name] for name in sensors)]

    def rig(self, robot, sensors, changes=()):
        head = re.sub(r"(?m)^robot: .*", "robot: " + robot, re.sub(r"(?m)^reference: .*", "reference: " + sensors[0], self.head))
        return changed("%s\nboards:\n%s\n%s\nsensors:\n%s" % (head, "".join(self.boards[one] for one in self.seen(sensors)), self.room,
                                                             "".join(self.sensors[name] for name in sensors)), changes)


def simulated(server, *arguments):
    done = subprocess.run(server.client("simulate", *arguments), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError("simulate: " + done.stderr.strip()[-300:])
    return done.stdout


class Bench:
    def __init__(self, context, folder, server):
        self.context, self.folder, self.server = context, folder, server
        self.mapper = Mapper(simulated(server, "--print-rig", "mars-mapper"))
        self.named = {}  # robot: its sensors and boards, of which any may be accused

    def visit(self, robot, sensors, *options, captures=20, days=2, changes=(), name="visit"):
        """The folder of a drawn session. `changes` are those of the rig, (old, new)."""
        place = self.folder / robot / name
        place.parent.mkdir(exist_ok=True)
        rig = place.with_suffix(".rig.yaml")
        rig.write_text(self.mapper.rig(robot, sensors, changes))
        seed = zlib.crc32((robot + name).encode()) % 1000
        simulated(self.server, rig, "--out", place, "--captures", captures, "--scale", 0.25, "--seed", seed, "--threads", 1,
                  "--captured-at", ago(days), *options)
        self.named[robot] = list(sensors) + self.mapper.seen(sensors)
        return place

    def push(self, folder, *options):
        return self.server.rigcal("push", folder, *options)

    def push_edges(self, robot, edges):
        path = self.folder / (robot + ".json")
        path.write_text(json.dumps({"format": 1, "edges": edges}))
        self.named[robot] = sorted({edge[end] for edge in edges for end in ("frame_a", "frame_b")})
        return self.server.rigcal("push-edges", path, "--robot", robot)
