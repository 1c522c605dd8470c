"""A disk that fills up while 59 edges are pushed: none of them counts; with room again, pushing them again gives all."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edges_files import block_edges  # noqa: E402
from flow import SKIPPED, Flow, check  # noqa: E402

EDGES = 59
DISK_BYTES, ROOM_BYTES = 16 << 20, 200 << 10  # room for the edge that a client asks with, not for all


def in_own_mounts():
    """Again as a process that may mount: as root, or as one that is root in a namespace of its own."""
    if os.environ.get("RIGCAL_OWN_MOUNTS"):
        return
    for command in (["unshare", "--mount"], ["unshare", "--mount", "--map-root-user"]):
        if shutil.which("unshare") and subprocess.run([*command, "true"], stderr=subprocess.DEVNULL).returncode == 0:
            os.execvpe(command[0], [*command, sys.executable, __file__], {**os.environ, "RIGCAL_OWN_MOUNTS": "1"})
    print("SKIPPED: a small disk cannot be mounted here")
    raise SystemExit(SKIPPED)


class SmallDisk(Flow):
    """The store is on a disk of its own."""

    def __enter__(self):
        self.disk = self.folder / "store"
        self.disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % DISK_BYTES, "tmpfs", str(self.disk)], capture_output=True)
        if mounted.returncode != 0:
            self.temporary.cleanup()
            print("SKIPPED: a small disk cannot be mounted here")
            raise SystemExit(SKIPPED)
        return super().__enter__()

    def __exit__(self, *_):
        self.server.stop()
        subprocess.run(["umount", str(self.disk)], check=True)
        self.temporary.cleanup()

    def fill(self):
        space = os.statvfs(self.disk)
        filler = self.disk / "filler"
        filler.write_bytes(b"x" * (space.f_bavail * space.f_frsize - ROOM_BYTES))
        return filler


def open_batches(flow):
    return json.loads(flow.rigcal("status", "--json").stdout)["open_batches"]


def refused_batch_counts_for_nothing(flow, path):
    done = flow.server.rigcal("push-edges", path, "--robot", "rig")
    check(done.returncode != 0 and "disk" in done.stderr, "the full disk is told: %d %s" % (done.returncode, done.stderr))
    batches = open_batches(flow)
    check(len(batches) == 1 and 0 < batches[0]["held"] < EDGES and batches[0]["edges"] == EDGES, "a part is stored: %r" % batches)
    robots = json.loads(flow.rigcal("robots", "--json").stdout)["robots"]
    check([row["edges"] for row in robots] == [0], "no edge counts: %r" % robots)
    check(robots[0]["revision"] is None, "there is no revision: %r" % robots)
    said = flow.rigcal("show", "rig", exit_code=4).stderr
    check("a batch of 59 edges is incomplete: %d of 59 since" % batches[0]["held"] in said, "show says why: " + said)
    check("a batch of 59 edges is incomplete" in flow.rigcal("status").stdout, "status tells of it")
    return batches[0]["held"]


def main():
    in_own_mounts()
    with SmallDisk() as flow:
        path = block_edges(flow.folder / "edges.json", EDGES)
        filler = flow.fill()
        held = refused_batch_counts_for_nothing(flow, path)
        filler.unlink()
        flow.kill_and_restart()
        check(open_batches(flow)[0]["held"] == held, "what had a receipt survives kill -9")
        check("no revision yet" in flow.rigcal("show", "rig", exit_code=4).stderr, "a restart makes no revision of it")
        again = json.loads(flow.server.rigcal("push-edges", path, "--robot", "rig", "--json").stdout)
        check(again["show"]["revision"] == 1, "the whole batch is revision 1: %r" % again["show"])
        check(len(json.loads(flow.rigcal("edges", "rig", "--json").stdout)["edges"]) == EDGES, "all edges are there")
        check(open_batches(flow) == [], "no batch is open")
    print("full_disk_batch: good")


main()
