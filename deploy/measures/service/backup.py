"""Backups of a store that is pushed to: nothing that a client has a receipt for is missing in any; flipped bytes are named; what it costs."""
import contextlib
import hashlib
import json
import pathlib
import random
import shutil
import sqlite3
import statistics
import subprocess
import threading
import time

from ..measure import at_most, equal, info
from ..server import Server
from ..sessions import noise_session
from .flips import named
from .kills import Observer

COPIES = 30
RESTORED_EVERY = 10
FLIPS = 1000
PAYLOAD_BYTES, PAYLOADS = 300_000, 60
ROUNDS = 5
STORE_SESSIONS = 8  # of the store whose backup is timed, 3 MB payloads
BIG_BYTES, BIG_PAYLOADS = 3_000_000, 25


class Client:
    """Pushes sessions of its own one after the other, and knows by their files what each receipt was for."""

    def __init__(self, server, folder):
        self.server, self.folder = server, folder
        self.digests = {}  # robot -> digests of its files in the order of their paths, which is that of the manifest
        self.stop = threading.Event()
        self.failed = None
        self.thread = threading.Thread(target=self.run, daemon=True)

    def run(self):
        try:
            while not self.stop.is_set():
                self.push("robot-%03d" % len(self.digests))
        except Exception as error:  # told by the measure's own thread
            self.failed = error

    def push(self, robot):
        session = noise_session(self.folder / robot, robot, PAYLOAD_BYTES, PAYLOADS, seed=len(self.digests))
        files = sorted(session.glob("*/*.png"), key=lambda path: path.relative_to(session).as_posix())
        self.digests[robot] = [hashlib.sha256(path.read_bytes()).hexdigest() for path in files]
        done = self.server.rigcal("push", session, "--no-wait")
        if done.returncode != 0:
            raise RuntimeError("push: " + done.stderr[-300:])
        shutil.rmtree(session)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stop.set()
        self.thread.join(timeout=300)


def newest(backup):
    return max(path for path in backup.glob("[0-9]*") if path.is_dir())


def missing(database_file, blobs, receipted, digests):
    """Receipted files that are not there as the client has them, or have no row."""
    database = sqlite3.connect("file:%s?mode=ro&immutable=1" % database_file, uri=True)
    lost = 0
    for session, indexes in receipted.items():
        row = database.execute("SELECT number, robot_id FROM session WHERE session_id = ?", (session,)).fetchone()
        held = {idx for (idx,) in database.execute("SELECT idx FROM payload_held WHERE session_number = ?", (row[0],))} if row else set()
        for idx in indexes:
            digest = digests[row[1]][idx] if row else ""
            blob = blobs / digest[:2] / digest
            lost += idx not in held or not blob.is_file() or hashlib.sha256(blob.read_bytes()).hexdigest() != digest
    database.close()
    return lost


def run_backup(context, data, backup, *more):
    done = subprocess.run([str(context.bin / "rigcal"), "backup", str(backup), "--data", str(data), "--json", *more],
                          capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise RuntimeError("backup: exit %d: %s%s" % (done.returncode, done.stdout[-300:], done.stderr[-300:]))
    return json.loads(done.stdout)


def restored_and_clean(context, backup, place):
    """Restores the newest backup; whether fsck has nothing to say of it."""
    subprocess.run([str(context.bin / "rigcal"), "restore-backup", str(backup), str(place)], check=True, capture_output=True, timeout=600)
    done = subprocess.run([str(context.bin / "rigcal"), "fsck", str(place), "--json"], capture_output=True, text=True, timeout=600)
    return done.returncode == 0 and json.loads(done.stdout)["damaged"] == 0


def copies(context, folder):
    """(receipted pictures missing over all copies, receipts that were there to be missed, restores that fsck found clean)"""
    lost = clean = 0
    backup = folder / "backup"
    with Server(context, folder / "store") as server:
        observer = Observer(server)
        with Client(server, folder) as client:
            while not observer.receipted():
                if client.failed:
                    raise client.failed
                time.sleep(0.05)
            for copy in range(COPIES):
                receipted = observer.receipted()
                run_backup(context, server.data, backup)
                lost += missing(newest(backup) / "rigcal.db", backup / "blobs", receipted, client.digests)
                if copy % RESTORED_EVERY == RESTORED_EVERY - 1:
                    place = folder / ("restored-%d" % copy)
                    clean += restored_and_clean(context, backup, place)
                if client.failed:
                    raise client.failed
        heard = sum(len(held) for held in receipted.values())
        observer.close()
    return lost, heard, clean


def push_s(server, folder, robot, seed):
    session = noise_session(folder / robot, robot, BIG_BYTES, BIG_PAYLOADS, seed=seed)
    done = server.rigcal("push", session, "--no-wait", "--json")
    if done.returncode != 0:
        raise RuntimeError("push: " + done.stderr[-300:])
    shutil.rmtree(session)
    return json.loads(done.stdout)["transfer_ns"] * 1e-9


@contextlib.contextmanager
def backups_without_end(context, data, folder):
    """Whole backups, one after the other, each into a new folder, while the body runs."""
    stop, failed, times_s = threading.Event(), [], []

    def loop():
        while not stop.is_set():
            backup = folder / ("backup-%d" % len(times_s))
            start = time.perf_counter()
            try:
                run_backup(context, data, backup)
            except Exception as error:  # told below
                failed.append(error)
                return
            times_s.append(time.perf_counter() - start)
            shutil.rmtree(backup)
    thread = threading.Thread(target=loop, daemon=True)
    thread.start()
    yield times_s
    stop.set()
    thread.join(timeout=600)
    if failed:
        raise failed[0]


def slowdown(context, folder):
    """(quiet s, s beside backups, s of a backup): medians of rounds that take turns."""
    quiet_s, beside_s, backup_s = [], [], []
    with Server(context, folder / "big-store") as server:
        for idx in range(STORE_SESSIONS):
            push_s(server, folder, "filler-%d" % idx, 1000 + idx)
        for turn in range(ROUNDS):
            quiet_s.append(push_s(server, folder, "quiet-%d" % turn, 2000 + turn))
            with backups_without_end(context, server.data, folder) as times_s:
                beside_s.append(push_s(server, folder, "beside-%d" % turn, 3000 + turn))
            backup_s += times_s
    return statistics.median(quiet_s), statistics.median(beside_s), statistics.median(backup_s)


def hashing_ms():
    """Of the content of a picture, by the library that the server holds it against its name with whenever it reads it."""
    content = random.Random(1).randbytes(BIG_BYTES)
    times_s = []
    for _ in range(20):
        start = time.perf_counter()
        hashlib.sha256(content).digest()
        times_s.append(time.perf_counter() - start)
    return statistics.median(times_s) * 1e3


def run(context):
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        lost, heard, clean = copies(context, folder)
        yield equal("receipted_pictures_missing_in_%d_copies" % COPIES, lost, 0)
        yield info("receipts_before_the_last_copy", heard)
        yield equal("restored_copies_that_fsck_finds_clean", clean, COPIES // RESTORED_EVERY)
        restored = max(folder.glob("restored-*"), key=lambda path: int(path.name.split("-")[1]))
        yield equal("flipped_bytes_named_of_%d" % FLIPS, named(context, restored, random.Random(20261126), FLIPS), FLIPS)
        quiet, beside, backup = slowdown(context, folder)
        yield info("backup_of_%d_MB" % (STORE_SESSIONS * BIG_PAYLOADS * BIG_BYTES // 1_000_000), backup, "s")
        yield at_most("push_beside_backups_against_quiet", beside / quiet, 1.2)
        yield info("holding_a_3MB_picture_against_its_name", hashing_ms(), "ms")
