"""kill -9 of client and server at random moments: what was receipted is there, and the end is that of a quiet run."""
import hashlib
import json
import pathlib
import random
import subprocess
import sqlite3
import threading
import time

from ..measure import at_least, equal, info, skip
from ..server import ANSWERED, Server
from ..sessions import add_noise, picture_session

KILLS = 100


class Observer:
    """A process that is never killed and hears every receipt: a witness apart from client and server."""

    def __init__(self, server):
        self.process = subprocess.Popen([str(server.context.bin / "receipt_recorder")], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, env=server.environment())
        if "ready" not in self.process.stdout.readline():
            raise RuntimeError("receipt_recorder did not start")
        self.held = {}  # session id -> payload indexes that were receipted
        self.closed = False
        self.lock = threading.Lock()
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()

    def listen(self):
        for line in self.process.stdout:
            receipt = json.loads(line)
            with self.lock:
                self.held.setdefault(receipt["subject"], set()).update(receipt["held"])
                self.closed = self.closed or receipt["state"] == "closed"

    def has_closed(self):
        with self.lock:
            return self.closed

    def receipted(self):
        with self.lock:
            return {subject: set(held) for subject, held in self.held.items()}

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=30)
        self.thread.join(timeout=30)
        self.process.stdout.close()


def lost_payloads(store, receipted):
    """Receipted payloads that are not on disk under their hash, or have no row that says so."""
    database = sqlite3.connect("file:%s?mode=ro" % (store / "rigcal.db"), uri=True)
    lost = 0
    for session, indexes in receipted.items():
        rows = dict(database.execute("SELECT idx, digest FROM payload JOIN payload_held USING (session_number, idx) "
                                     "JOIN session ON session.number = session_number WHERE session_id = ?", (session,)))
        for idx in indexes:
            digest = rows.get(idx)
            blob = store / "blobs" / (digest or "")[:2] / (digest or "")
            if not digest or not blob.is_file() or hashlib.sha256(blob.read_bytes()).hexdigest() != digest:
                lost += 1
    database.close()
    return lost


def newest(server, robot):
    done = server.rigcal("show", robot, "--json")
    if done.returncode not in ANSWERED:
        raise RuntimeError("show: " + done.stderr[-300:])
    return json.loads(done.stdout)


def quiet_run(context, folder, session):
    with Server(context, folder / "quiet") as server:
        start = time.perf_counter()
        done = server.rigcal("push", session)
        if done.returncode not in ANSWERED:
            raise RuntimeError("push: " + done.stderr[-300:])
        return newest(server, "victim"), time.perf_counter() - start


class Round:
    """One session into one store, disturbed until it is through."""

    def __init__(self, context, folder, session, chance):
        self.server, self.session, self.chance = Server(context, folder), session, chance
        self.client_kills = self.server_kills = self.lost = self.under_way = 0

    def kill_once(self, span_s):
        """Starts a push, kills one of the two after a random time, and looks at the disk. True: the push got through."""
        client = subprocess.Popen(self.server.client("push", self.session), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  env=self.server.environment())
        try:
            client.wait(timeout=self.chance.uniform(0.0, span_s))
            return True
        except subprocess.TimeoutExpired:
            pass
        self.under_way += not self.observer.has_closed()
        if self.chance.random() < 0.5:
            self.client_kills += 1
        else:
            self.server.kill()
            self.server_kills += 1
            self.lost += lost_payloads(self.server.data, self.observer.receipted()) if (self.server.data / "rigcal.db").exists() else 0
            self.server.start().wait_ready()
        client.kill()
        client.wait()
        return False

    def run(self, span_s, kills_max):
        self.server.start().wait_ready()
        self.observer = Observer(self.server)
        while self.client_kills + self.server_kills < kills_max and not self.kill_once(span_s):
            pass
        done = self.server.rigcal("push", self.session)
        if done.returncode not in ANSWERED:
            raise RuntimeError("push after the kills: " + done.stderr[-300:])
        document = newest(self.server, "victim")
        self.lost += lost_payloads(self.server.data, self.observer.receipted())
        self.heard = sum(len(held) for held in self.observer.receipted().values())
        self.observer.close()
        self.server.stop()
        return document


def run(context):
    pictures = context.data / "stereo_opencv"
    if not pictures.is_dir():
        yield skip("kills", "no data in stereo_opencv")
        return
    chance = random.Random(20261120)
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        session = picture_session(folder / "session", "victim", pictures)
        add_noise(session, 1_500_000, 40, seed=3)
        quiet, quiet_s = quiet_run(context, folder, session)
        rounds, different, kills, heard, under_way = [], 0, 0, 0, 0
        while kills < KILLS:
            one = Round(context, folder / ("round-%d" % len(rounds)), session, chance)
            # Half of the rounds kill early, while payloads travel; the others anywhere up to the report.
            document = one.run(quiet_s * (0.3 if len(rounds) % 2 == 0 else 1.2), min(10, KILLS - kills))
            rounds.append(one)
            kills += one.client_kills + one.server_kills
            heard += one.heard
            under_way += one.under_way
            different += document["document"] != quiet["document"] or document["digest"] != quiet["digest"]
        yield at_least("kills", kills, KILLS)
        yield info("kills_of_client", sum(one.client_kills for one in rounds))
        yield info("kills_of_server", sum(one.server_kills for one in rounds))
        yield at_least("receipts_witnessed", heard, 100)
        yield at_least("kills_while_payloads_were_under_way", under_way, 20)
        yield equal("receipted_payloads_lost", sum(one.lost for one in rounds), 0)
        yield equal("final_revisions_that_differ", different, 0)
