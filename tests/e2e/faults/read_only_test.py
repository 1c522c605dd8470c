"""A store on a disk that is mounted read-only, as a dying one is: a whole one is looked at and backed up; one whose last changes are in the
log is refused with the reason, and never called damaged."""
import json
import pathlib
import shlex
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import SKIPPED, Flow, check  # noqa: E402
from measures.sessions import noise_session  # noqa: E402

MOUNT = "mount --bind %s %s && mount -o remount,bind,ro %s && "
GOOD, DAMAGE, REFUSED = 0, 1, 4  # exit codes


class Mounted:
    """The store's folder at another place, where nobody can write; of each command alone."""

    def __init__(self, flow):
        self.flow, self.place = flow, flow.folder / "read#only?"
        self.place.mkdir()

    def run(self, *command):
        mount = MOUNT % tuple(shlex.quote(str(path)) for path in (self.flow.server.data, self.place, self.place))
        return subprocess.run(["unshare", "-m", "sh", "-c", mount + shlex.join(map(str, command))], capture_output=True, text=True, timeout=300,
                              env=self.flow.server.environment())

    def rigcal(self, *arguments, exit_code):
        done = self.run(*self.flow.server.client(*arguments))
        check(done.returncode == exit_code, "%r: exit %d instead of %d: %s%s" % (arguments, done.returncode, exit_code, done.stdout, done.stderr))
        return done


def looked_at(flow, disk):
    told = json.loads(disk.rigcal("fsck", disk.place, "--json", exit_code=GOOD).stdout)
    check(told["damaged"] == 0 and told["files"] >= 6 and told["pages"] > 0, "all of it is looked at: %r" % told)
    disk.rigcal("backup", flow.folder / "backup", "--data", disk.place, exit_code=GOOD)
    flow.rigcal("restore-backup", flow.folder / "backup", flow.folder / "restored")
    flow.rigcal("fsck", flow.folder / "restored")
    blob = next((flow.server.data / "blobs").glob("??/*"))
    whole = blob.read_bytes()
    blob.write_bytes(whole[:-1])
    told = disk.rigcal("fsck", disk.place, exit_code=DAMAGE).stdout
    check("1 things are damaged" in told, "what is damaged is told there, too: " + told)
    blob.write_bytes(whole)


def refused(flow, disk):
    flow.server.start(*flow.arguments)
    flow.ready()
    flow.server.kill()
    check((flow.server.data / "rigcal.db-wal").exists(), "a server that was killed leaves its log")
    for command in (("fsck", disk.place), ("backup", flow.folder / "backup", "--data", disk.place)):
        told = disk.rigcal(*command, exit_code=REFUSED).stderr
        check("is read-only" in told and "Mount it writable, or copy" in told, "it says why, and what to do: " + told)
    flow.server.start(*flow.arguments)  # what the killed one has left running is gone when this one has stopped
    flow.ready()


def main():
    with Flow() as flow:
        disk = Mounted(flow)
        if disk.run("true").returncode != 0:
            print("SKIPPED: this user may not mount")
            raise SystemExit(SKIPPED)
        flow.rigcal("push", noise_session(flow.folder / "session", "mapper-01", 20_000, 6, 7), "--new-robot", "--no-wait")
        flow.server.stop()
        check(not (flow.server.data / "rigcal.db-wal").exists(), "a server that is stopped leaves no log")
        looked_at(flow, disk)
        refused(flow, disk)
    print("read-only: good")


main()
