"""A real server on the disk that a power loss left: everything is pushed again, and the end is that of a quiet run."""
import json
import pathlib
import sqlite3
import subprocess
import tempfile

from crashed_disk import write_down
from measures.server import ANSWERED, Server
from power_scene import push_everything

COUNTED = ("session", "payload_held", "batch", "batch_item", "edge", "counted_edge")


class Start(Server):
    """Without a word to the terminal; what it says is in `said`."""

    def __init__(self, context, data, said):
        super().__init__(context, data)
        self.said = said

    def start(self, *arguments):
        self.log = open(self.said, "a")
        self.process = subprocess.Popen([str(self.context.bin / "rigcald"), "--data", str(self.data), "--http", "127.0.0.1:0", *arguments],
                                        stdout=subprocess.PIPE, stderr=self.log, text=True, env=self.environment())
        return self


def newest(server, robot):
    done = server.rigcal("show", robot, "--json")
    if done.returncode not in ANSWERED:
        raise RuntimeError("show %s: %s" % (robot, done.stderr[-300:]))
    told = json.loads(done.stdout)
    return {"document": told["document"], "digest": told["digest"]}


def counts(store):
    database = sqlite3.connect("file:%s?mode=ro" % (store / "rigcal.db"), uri=True)
    rows = {table: database.execute("SELECT count(*) FROM " + table).fetchone()[0] for table in COUNTED}
    database.close()
    return rows


def end_of(scene, found=None, place=None):
    """What is told and counted at the end, of a new store or of one that a power loss left."""
    with tempfile.TemporaryDirectory(dir=place) as temporary:
        disk = pathlib.Path(temporary) / "disk"
        write_down(found or {}, disk)
        with Start(scene.context, disk / "store", pathlib.Path(temporary) / "said") as server:
            push_everything(server, scene.session, scene.edges)
            told = {robot: newest(server, robot) for robot in ("victim", "rig")}
            rows = counts(disk / "store")
        reports = sorted(path.relative_to(disk).as_posix() for path in (disk / "store" / "reports" / "victim").rglob("*.html"))
        return {"told": told, "rows": rows, "reports of the session": reports}
