"""A server that only takes in, and a worker with a folder of its own: rows in PostgreSQL, files in a bucket. What was pushed to the one is computed
by the other, whose pictures and report the first one serves; ids and digests are those of a quiet server on SQLite."""
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile
import urllib.request

sys.path.insert(0, os.path.dirname(__file__))
from both_engines import database_url, in_database, push, told, with_postgres  # noqa: E402
from flow import Flow, check  # noqa: E402
from s3_service import S3Service  # noqa: E402

PLACE = "s3://rigs/workers"


def blobs(folder):
    return {path.name for path in folder.glob("blobs/*/*")}


def on_sqlite():
    with Flow() as flow:
        push(flow)
        return told(flow)


def start_worker(flow, folder):
    return subprocess.Popen([flow.context.bin / "rigcal-worker", "--data", folder, "--blobs", PLACE, "--threads", "1"], env=flow.server.environment(),
                            stdout=subprocess.PIPE, stderr=open(flow.folder / "worker.log", "a"), text=True)


def computed_elsewhere(flow):
    folder = flow.folder / "worker"
    folder.mkdir()
    (flow.server.data / "reports").mkdir(exist_ok=True)
    (folder / "reports").symlink_to(flow.server.data / "reports")  # as one mounted folder would be
    worker = start_worker(flow, folder)
    try:
        check("works as" in worker.stdout.readline(), "the worker runs: " + (flow.folder / "worker.log").read_text())
        push(flow)
        answers = told(flow)
        pushed = blobs(flow.server.data)
        made = blobs(folder) - pushed
        check(pushed and made, "each folder has what its process used: %d, %d" % (len(pushed), len(made)))
        page = flow.get("/robots/mapper/sessions/%s/" % answers["sessions"][-1])
        shown = [name for name in made if name + ".jpg" in page]
        check(shown, "the session's page shows pictures that the worker made")
        picture = "%s/robots/mapper/sessions/%s/evidence/%s.jpg" % (flow.address, answers["sessions"][-1], shown[0])
        with urllib.request.urlopen(picture, timeout=60) as reply:
            check(hashlib.sha256(reply.read()).hexdigest() == shown[0], "the picture is what its name says")
        check(shown[0] in blobs(flow.server.data), "this server fetched it")
        check("mapper" in flow.get("/robots/mapper/revisions/1/"), "and the report")
        return answers
    finally:
        worker.terminate()
        worker.wait(timeout=60)


def main():
    with_postgres(__file__)
    quiet = on_sqlite()
    with tempfile.TemporaryDirectory(prefix="rigcal-s3-") as folder, S3Service(pathlib.Path(folder)):
        in_database("CREATE DATABASE bucket")
        os.environ["RIGCAL_STORE"] = database_url("bucket")
        with Flow("--blobs", PLACE, "--threads", "0") as flow:
            check(computed_elsewhere(flow) == quiet, "the same ids and digests as on SQLite")


main()
