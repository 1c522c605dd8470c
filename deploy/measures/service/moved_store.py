"""A store of many robots that goes from SQLite to PostgreSQL, quiet and killed at random points: seconds, and whether ids, digests and documents are
the same, as other programs read both. Run by servers.py, with a database server of its own."""
import hashlib
import json
import os
import pathlib
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "deploy"))
from measures.measure import Context  # noqa: E402
from measures.server import Server  # noqa: E402
from measures.sessions import noise_session  # noqa: E402

ROBOTS, VISITS, KILLS = 1000, 12, 30
SAME = {
    "ids": ("SELECT robot_id FROM robot ORDER BY 1", "SELECT session_id FROM session ORDER BY number", "SELECT edge_id FROM edge ORDER BY number",
            "SELECT number FROM counted_edge ORDER BY 1"),
    "digests": ("SELECT robot_id || number || digest FROM revision ORDER BY robot_id, number", "SELECT digest FROM payload ORDER BY session_number, idx"),
    "documents": ("SELECT %s FROM revision_document ORDER BY robot_id, revision_number", "SELECT manifest FROM session ORDER BY number"),
}
HEX = {"sqlite": "lower(hex(zstd))", "postgres": "encode(zstd, 'hex')"}


def in_postgres(url, sql):
    done = subprocess.run(["psql", "--no-psqlrc", "--tuples-only", "--no-align", url, "--command", "SET search_path = rigcal; " + sql],
                          capture_output=True, text=True, check=True)
    return done.stdout.split("\n", 1)[1].rstrip("\n").split("\n")  # the first line is of SET


def digest_of(rows):
    return len(rows), hashlib.sha256("\n".join(rows).encode()).hexdigest()


def differences(data, url):
    """Of SAME, how many are not."""
    database = sqlite3.connect("file:%s?mode=ro" % (data / "rigcal.db"), uri=True)
    wrong = 0
    for queries in SAME.values():
        for sql in queries:
            here = [str(value) for (value,) in database.execute(sql.replace("%s", HEX["sqlite"]))]
            wrong += not here or digest_of(here) != digest_of(in_postgres(url, sql.replace("%s", HEX["postgres"])))
    database.close()
    return wrong


def files_that_differ(data, moved):
    found = {path.relative_to(data / "blobs") for path in (data / "blobs").glob("*/*")}
    return sum(not (moved / "blobs" / one).samefile(data / "blobs" / one) for one in found) + (not found)


def fill(context, data, folder):
    subprocess.run([str(context.bin / "page_store"), "fleet", str(data), str(ROBOTS), str(VISITS)], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    with Server(context, data) as server:
        done = server.rigcal("push", noise_session(folder / "session", "pushed", 100_000, 40, 1), "--no-wait")
        if done.returncode != 0:
            raise RuntimeError("push: " + done.stderr)


def migrate(context, data, url, moved):
    done = subprocess.run([str(context.bin / "rigcal"), "migrate-store", "sqlite:%s" % data, url, "--data", str(moved), "--json"], capture_output=True,
                          text=True)
    if done.returncode != 0:
        raise RuntimeError("migrate-store: " + done.stderr)
    return json.loads(done.stdout)


def killed(context, data, url, moved, quiet_s):
    """How many of the kills came while it was under way."""
    chance, count = random.Random(24), 0
    for _ in range(KILLS):
        command = [str(context.bin / "rigcal"), "migrate-store", "sqlite:%s" % data, url, "--data", str(moved)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(timeout=chance.uniform(0.0, 0.12 * quiet_s))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        count += process.wait() == -signal.SIGKILL
    return count


def database(name):
    before, after = os.environ["RIGCAL_TEST_POSTGRES"], os.environ["RIGCAL_TEST_POSTGRES_OPTIONS"]
    subprocess.run(["psql", "--quiet", "--no-psqlrc", before + "postgres" + after, "--command", "CREATE DATABASE " + name], check=True)
    return before + name + after


def main():
    context = Context(full=False)
    context.bin = pathlib.Path(os.environ["RIGCAL_BIN"])
    with tempfile.TemporaryDirectory(prefix="rigcal-moved-") as name:
        folder = pathlib.Path(name)
        data = folder / "data"
        fill(context, data, folder)
        quiet, broken = database("quiet"), database("broken")
        began = time.monotonic()
        told = migrate(context, data, quiet, folder / "quiet")
        seconds = time.monotonic() - began
        print("seconds %.1f" % seconds, "rows %d" % told["rows"], "files %d" % told["files"], flush=True)
        print("kills %d" % killed(context, data, broken, folder / "broken", seconds), flush=True)
        if (folder / "broken" / "unfinished-copy").exists():
            migrate(context, data, broken, folder / "broken")
        wrong = sum(differences(data, url) + files_that_differ(data, folder / where) for url, where in ((quiet, "quiet"), (broken, "broken")))
        print("differences %d" % wrong, flush=True)


main()
