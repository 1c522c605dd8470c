"""What was promised to somebody outside by the marks of a recording, and what of it a disk after a power loss does not keep."""
import hashlib
import json
import pathlib
import shutil
import sqlite3
import subprocess
import tempfile

from crashed_disk import Everything, write_down

STORE = "store"


class Promised:
    """Grows with the marks."""

    def __init__(self):
        self.held = {}          # session or batch -> indexes that have a receipt
        self.closed = set()
        self.revisions = set()  # (robot, number)
        self.rows = {}          # table -> how many rows somebody was told of
        self.kept = {}          # path -> contents that it may have, of what a program said to have written
        self.serving = False
        self.damaged = None     # digest of what was damaged on purpose

    def hear(self, mark, disk):
        word, *rest = mark.split()
        if word == "held":
            self.held.setdefault(rest[0], set()).update(map(int, rest[2:]))
            if rest[1] == "closed":
                self.closed.add(rest[0])
        elif word == "calibration":
            self.revisions.add((rest[0], int(rest[1])))
        elif word == "serving":
            self.serving = True
        elif word == "damaged":
            self.damaged = rest[0]
        elif word == "rows":
            self.rows[rest[0]] = int(rest[1])
        elif word == "kept":
            self.keep(rest[0], disk.after_power_loss(Everything))
        elif word == "or":
            self.kept[rest[0]] = self.kept[rest[0]] + [rest[1].encode()]

    def keep(self, above, now):
        of_it = {path: content for path, content in now.items() if path == above or path.startswith(above + "/")}
        if not of_it:
            raise RuntimeError("there is no " + above)
        self.kept.update((path, [content]) for path, content in of_it.items())

    def is_damaged(self, text):
        return self.damaged is not None and self.damaged in text

    def broken_by(self, found, facts, final):
        """Sentences. `final`: the files as they are when nothing is lost; published reports are among them."""
        for path, contents in self.kept.items():
            if found.get(path, b"missing") not in contents:
                yield "%s is not as it was told to be" % path
        if self.serving and not found.get(STORE + "/run", b"").startswith(b"-"):
            yield "the note of a run is lost"
        for problem in facts.problems:
            if not self.is_damaged(problem):
                yield problem
        for subject, indexes in self.held.items():
            for idx in sorted(indexes - facts.held.get(subject, set())):
                yield "item %d of %s is lost" % (idx, subject[:12])
        for subject in sorted(self.closed - facts.closed):
            yield "%s is not closed" % subject[:12]
        for robot, number in sorted(self.revisions - facts.revisions):
            yield "revision %d of %s is lost" % (number, robot)
        for table, count in self.rows.items():
            if facts.rows.get(table, 0) < count:
                yield "of %d rows of %s %d are lost" % (count, table, count - facts.rows.get(table, 0))
        for robot, number in sorted(facts.published):
            above = "%s/reports/%s/%d/" % (STORE, robot, number)
            wanted = {path: content for path, content in final.items() if path.startswith(above) and not self.is_damaged(path)}
            lost = [path for path, content in wanted.items() if found.get(path, b"missing") != content]
            if lost or not wanted:
                yield "of %d files below %s %d are lost, the first %s" % (len(wanted), above, len(lost), (lost or [""])[0])


class Facts:
    """What a store says that a power loss left."""

    def __init__(self, found, programs, place):
        self.held, self.rows, self.closed, self.revisions, self.published, self.problems = {}, {}, set(), set(), set(), []
        store = {path: content for path, content in found.items() if path == STORE or path.startswith(STORE + "/")}
        if not store.get(STORE + "/rigcal.db"):
            return
        folder = pathlib.Path(tempfile.mkdtemp(dir=place)) / "disk"
        try:
            write_down(store, folder)
            self.look(folder / STORE, programs)
        finally:
            shutil.rmtree(folder.parent)

    def look(self, store, programs):
        database = sqlite3.connect("file:%s?mode=rw" % self.copy(store), uri=True)
        try:
            if database.execute("PRAGMA user_version").fetchone()[0] == 0:
                return
            self.read(database, store)
        except sqlite3.Error as error:
            self.problems.append("the database cannot be read: %s" % error)
        finally:
            database.close()
        self.check(store, programs)

    @staticmethod
    def copy(store):
        """So that fsck sees what the disk has, and not what was made of it here."""
        beside = store.parent / "copy"
        beside.mkdir()
        for end in ("", "-wal", "-journal"):
            if (store / ("rigcal.db" + end)).exists():
                shutil.copyfile(store / ("rigcal.db" + end), beside / ("rigcal.db" + end))
        return beside / "rigcal.db"

    def read(self, database, store):
        said = database.execute("PRAGMA integrity_check").fetchone()[0]
        if said != "ok":
            self.problems.append("integrity_check: " + said)
        of_sessions = ("SELECT session_id, idx, digest FROM payload JOIN payload_held USING (session_number, idx) "
                       "JOIN session ON session.number = session_number")
        for subject, idx, digest in database.execute(of_sessions):
            if self.is_whole(store / "blobs" / digest[:2] / digest):
                self.held.setdefault(subject, set()).add(idx)
        for subject, idx in database.execute("SELECT batch_id, idx FROM batch_item JOIN batch ON batch.number = batch_number"):
            self.held.setdefault(subject, set()).add(idx)
        self.closed = {row[0] for row in database.execute("SELECT session_id FROM session JOIN session_closed ON number = session_number")}
        self.closed |= {row[0] for row in database.execute(
            "SELECT batch_id FROM batch WHERE item_count = (SELECT count(*) FROM batch_item WHERE batch_number = batch.number)")}
        self.revisions = set(database.execute("SELECT robot_id, number FROM revision"))
        self.published = set(database.execute("SELECT robot_id, revision_number FROM publication"))
        self.rows = {table: database.execute("SELECT count(*) FROM " + table).fetchone()[0] for table in ("decision", "account", "audit")}
        for (digest,) in database.execute("SELECT digest FROM edge_evidence"):
            if not self.is_whole(store / "blobs" / digest[:2] / digest):
                self.problems.append("evidence %s is lost" % digest)

    @staticmethod
    def is_whole(blob):
        return blob.is_file() and hashlib.sha256(blob.read_bytes()).hexdigest() == blob.name

    def check(self, store, programs):
        done = subprocess.run([str(programs / "rigcal-upkeep"), "fsck", str(store), "--json"], capture_output=True, text=True, timeout=120)
        if done.returncode not in (0, 1):
            self.problems.append("fsck: exit %d: %s" % (done.returncode, done.stderr[-300:]))
            return
        findings = json.loads(done.stdout)["findings"]
        self.problems += ["fsck: " + one["what"] for one in findings if one["state"] == "damage"]
