"""What is recorded for the power losses: real programs, everything that they promise to keep, and each way in which they sync."""
import json
import os
import pathlib
import select
import subprocess
import sys
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "deploy"), str(ROOT / "tests" / "e2e"), str(ROOT / "tests" / "fault")]
from disk_record import Recording  # noqa: E402
from edge_case import edge  # noqa: E402
from measures.server import ANSWERED, Server  # noqa: E402
from measures.sessions import picture_session  # noqa: E402

CAPTURES = 4
TRIANGLE = [("a", "b", 1.0), ("b", "c", 1.0), ("a", "c", 2.003)]


class RecordedServer(Server):
    def __init__(self, context, recording, tag=None):
        super().__init__(context, recording.root / "store", tag)
        self.recording = recording

    def environment(self):
        return {**super().environment(), **self.recording.environment()}

    def start(self, *arguments):
        self.log = open(self.recording.log.with_suffix(".said"), "a")
        self.process = subprocess.Popen([str(self.context.bin / "rigcald"), "--data", str(self.data), "--http", "127.0.0.1:0", *arguments],
                                        stdout=subprocess.PIPE, stderr=self.log, text=True, env=self.environment())
        return self

    def serve(self):
        self.start().wait_ready()
        self.recording.mark("serving")
        return self

    def __enter__(self):
        return self.serve()


class Scene:
    """Inputs in `folder`, all that is recorded in `folder`/disk."""

    def __init__(self, context, folder):
        self.context, self.folder = context, pathlib.Path(folder)
        self.recording = Recording(context.bin / "librigcal_disk_recorder.so", self.folder / "disk", self.folder / "record")
        self.server = RecordedServer(context, self.recording)
        self.session = self.make_session()
        self.edges = [self.make_edges(name, shift) for name, shift in (("first", 0.0), ("second", 1e-4), ("third", 2e-4), ("fourth", 3e-4))]

    def make_session(self):
        session = picture_session(self.folder / "session", "victim", self.context.stereo_pairs())
        for side in ("left", "right"):
            for picture in sorted((session / side).iterdir())[CAPTURES:]:
                picture.unlink()
        return session

    def make_edges(self, name, shift_m):
        path = self.folder / (name + ".json")
        path.write_text(json.dumps({"format": 1, "edges": [edge(a, b, x + shift_m) for a, b, x in TRIANGLE]}))
        return path

    def ask(self, *arguments, good=ANSWERED):
        return asked(self.server, *arguments, good=good)

    def at(self, *names):
        return str(pathlib.Path(self.recording.root, *names))

    def run_recorded(self, *command):
        done = subprocess.run(command, env=self.server.environment(), capture_output=True, text=True, timeout=120)
        if done.returncode != 0:
            raise RuntimeError("%s: exit %d: %s" % (command, done.returncode, done.stderr[-300:]))

    def record(self):
        self.push_all()
        self.back_up()
        self.be_killed()
        self.be_damaged()
        self.write_files()
        return self

    def push_all(self):
        with self.server:
            push_everything(self.server, self.session, self.edges[:1])
            self.ask("approve", "rig", "1", "--by", "Ada", "--reason", "measured")
            self.recording.mark("rows decision 1")

    def back_up(self):
        """While it serves; before that it was stopped in order, so the log was written into the database."""
        with self.server:
            self.ask("push-edges", self.edges[1], "--robot", "rig")
            self.ask("backup", self.at("backup"), "--data", self.server.data)
            self.recording.mark("kept backup")
            self.ask("push-edges", self.edges[2], "--robot", "rig")  # into pages whose sums the backup made durable
            wait_published(self.server)

    def be_killed(self):
        """Another program looks into the store and takes the log into the database: the sums of its pages are not ours then."""
        self.server.serve()
        self.ask("push-edges", self.edges[3], "--robot", "rig")
        wait_published(self.server)
        kill_with_workers(self.server)
        look = "import sqlite3, sys; d = sqlite3.connect(sys.argv[1]); d.execute('SELECT count(*) FROM edge').fetchall(); d.close()"
        self.run_recorded(sys.executable, "-c", look, str(self.server.data / "rigcal.db"))
        if (self.server.data / "rigcal.db-wal").exists():
            raise RuntimeError("the other program left the log: somebody else has the database open")
        with self.server:
            self.ask("push-edges", self.edges[0], "--robot", "rig")

    def be_damaged(self):
        blob = next(path for path in sorted((self.server.data / "blobs").glob("??/*")))
        self.recording.mark("damaged %s" % blob.name)
        self.run_recorded("dd", "if=/dev/zero", "of=%s" % blob, "bs=1", "count=1", "seek=100", "conv=notrunc,fsync")
        self.run_recorded(*self.server.client("fsck", self.server.data, "--repair"))
        aside = blob.with_name(blob.name + ".damaged")
        self.recording.mark("kept %s" % aside.relative_to(self.recording.root))

    def write_files(self):
        self.ask("restore-backup", self.at("backup"), self.at("restored"))
        self.recording.mark("kept restored")
        self.ask("migrate-store", "sqlite:" + self.at("restored"), "sqlite:" + self.at("moved"))
        self.recording.mark("kept moved")
        self.ask("identity", "init", "--authority", self.at("authority"))
        self.ask("identity", "new", "robot", "mapper-01", "--authority", self.at("authority"))
        self.recording.mark("kept authority/robots/mapper-01")


def kill_with_workers(server, patience_s=30):
    """Also waits for the processes that work for it: they end when it is gone, and have the database open until then."""
    workers = [os.pidfd_open(pid) for pid in server.processes()[1:]]
    server.kill()
    for worker in workers:
        ended, _, _ = select.select([worker], [], [], patience_s)
        os.close(worker)
        if not ended:
            raise RuntimeError("a process that works for a killed rigcald goes on")


def asked(server, *arguments, good=ANSWERED):
    done = server.rigcal(*arguments)
    if done.returncode not in good:
        raise RuntimeError("rigcal %s: exit %d: %s" % (" ".join(map(str, arguments)), done.returncode, done.stderr[-500:]))
    return done.stdout


def push_everything(server, session, edge_files):
    asked(server, "push", session)
    for edges in edge_files:
        asked(server, "push-edges", edges, "--robot", "rig")
    wait_published(server)


def wait_published(server, patience_s=120):
    until = time.monotonic() + patience_s
    while time.monotonic() < until:
        with urllib.request.urlopen(server.address + "/api/v1/live", timeout=20) as reply:
            if json.loads(reply.read())["unfinished"] == 0:
                return
    raise RuntimeError("not everything is published")
