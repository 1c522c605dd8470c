"""A store with its files in a bucket (--blobs): the server is killed between upload and receipt, the S3 service is gone amid a push and comes
back, the folder loses its copies. Nothing is lost or done twice, and the results are those of a quiet server without a bucket."""
import contextlib
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

sys.path.insert(0, os.path.dirname(__file__))
from both_engines import push, push_edges, told  # noqa: E402
from flow import NOT_FAILED, Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402
from s3_service import S3Service  # noqa: E402

PATIENCE_S = 120
PLACE = "s3://rigs/one"


def on_sqlite():
    with Flow() as flow:
        push(flow)
        return told(flow)


def wait_until(what, holds):
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        if holds():
            return
        os.sched_yield()
    check(False, what)


def rows(flow, table):
    with contextlib.closing(sqlite3.connect("file:%s?mode=ro" % (flow.server.data / "rigcal.db"), uri=True, timeout=30)) as database:
        return database.execute("SELECT count(*) FROM " + table).fetchone()[0]


def blobs(flow):
    return [path for path in flow.server.data.glob("blobs/*/*") if len(path.name) == 64]


def simulate(flow, name, seed):
    flow.rigcal("simulate", front_rig(flow, "mapper", "rig"), "--out", flow.folder / name, "--seed", seed, "--captures", 12, "--scale", 0.3,
                "--captured-at", "2026-01-31T10:00:00Z" if seed == 1 else "2026-02-28T10:00:00Z")


def begin_push(flow, name):
    return subprocess.Popen(flow.server.client("push", flow.folder / name), env=flow.server.environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def await_pushed(client):
    said, _ = client.communicate(timeout=2 * PATIENCE_S)
    check(client.returncode in NOT_FAILED, "the push ended with %d: %s" % (client.returncode, said))


def killed_before_the_receipt(flow, s3):
    """All is uploaded, and the row that says so is held up: then the server is killed."""
    push_edges(flow, 0)
    push_edges(flow, 3)
    simulate(flow, "session", 1)
    s3.pause()
    client = begin_push(flow, "session")
    wait_until("files are moved to their places", lambda: rows(flow, "session") == 1 and blobs(flow))
    holder = sqlite3.connect(flow.server.data / "rigcal.db", isolation_level=None, timeout=30)
    holder.execute("BEGIN IMMEDIATE")
    s3.resume()
    wait_until("they are uploaded", lambda: s3.objects() > len(blobs(flow)))  # and the object that names the store
    flow.server.kill()
    holder.execute("ROLLBACK")
    holder.close()
    check(rows(flow, "payload_held") == 0, "nothing had a receipt")
    flow.server.start(*flow.arguments)
    flow.address = flow.ready()
    await_pushed(client)
    answers = told(flow)
    check(s3.objects() == len(blobs(flow)) + 1, "each file is there once: %d objects, %d files" % (s3.objects(), len(blobs(flow))))
    return answers


def readiness(flow):
    try:
        return 200, flow.get("/readyz")
    except urllib.error.HTTPError as answer:
        return answer.code, answer.read().decode()


def gone_amid_a_push(flow, s3):
    simulate(flow, "later", 2)
    held = rows(flow, "payload_held")
    s3.stop()
    client = begin_push(flow, "later")
    wait_until("/readyz says why", lambda: PLACE in readiness(flow)[1])
    status, text = readiness(flow)
    check(status == 503 and "%s at %s" % (PLACE, s3.address.split("//")[1]) in text and "cannot be reached" in text, "%d %s" % (status, text))
    wait_until("the session came", lambda: rows(flow, "session") == 2)
    check(client.poll() is None and rows(flow, "payload_held") == held, "nothing is acknowledged, and the client waits")
    s3.start()
    await_pushed(client)
    wait_until("/readyz is good again", lambda: readiness(flow)[0] == 200)
    wait_published(flow)


def report_of(flow):
    page = flow.get("/robots/mapper/revisions/1/")
    pictures = sorted(path.relative_to(flow.server.data).as_posix() for path in flow.server.data.glob("reports/mapper/1/evidence/*"))
    check(pictures, "the report has pictures")
    return page, pictures


def without_its_copies(flow):
    before = report_of(flow)
    flow.server.stop()
    for folder in ("blobs", "reports"):
        shutil.rmtree(flow.server.data / folder)
    flow.server.start(*flow.arguments)
    flow.address = flow.ready()

    def is_drawn():
        with contextlib.suppress(urllib.error.HTTPError):
            return bool(flow.get("/robots/mapper/revisions/1/"))

    wait_until("the report is drawn again", is_drawn)
    check(report_of(flow) == before, "the same report, of files that were fetched")


def refused(flow):
    flow.server.stop()
    program = [flow.context.bin / "rigcald", "--data", flow.server.data, "--http", "127.0.0.1:0"]
    secret = os.environ["AWS_SECRET_ACCESS_KEY"]
    for arguments, changed, wanted in (
            ((), {}, "are in %s. Give --blobs %s." % (PLACE, PLACE)),
            (("--blobs", "s3://rigs/two"), {}, "are in %s, not in s3://rigs/two. Give --blobs %s." % (PLACE, PLACE)),
            (("--blobs", PLACE), {"AWS_SECRET_ACCESS_KEY": "wrong"}, "the secret is wrong"),
            (("--blobs", PLACE), {"AWS_SECRET_ACCESS_KEY": ""}, "there is no key for the bucket of --blobs"),
            (("--blobs", "s3://key:hidden@rigs"), {}, "--blobs is not s3://BUCKET")):
        done = subprocess.run([*program, *arguments], env={**flow.server.environment(), **changed}, capture_output=True, text=True, timeout=60)
        check(done.returncode != 0 and wanted in done.stderr, "%r: exit %d, %s" % (arguments, done.returncode, done.stderr))
    written = "".join(path.read_text(errors="replace") for path in pathlib.Path(flow.folder).glob("*.log"))
    check(secret not in written and secret not in json.dumps(done.args, default=str), "the secret is nowhere in the log")


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-s3-") as folder, S3Service(pathlib.Path(folder)) as s3, Flow("--blobs", PLACE) as flow:
        answers = killed_before_the_receipt(flow, s3)
        gone_amid_a_push(flow, s3)
        without_its_copies(flow)
        refused(flow)
    check(answers == on_sqlite(), "the same ids and digests as without a bucket")


main()
