"""A full disk: what is stored is read, pushes are refused by name, health says so; also after a restart; then all goes on."""
import json
import pathlib
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edges_test import triangle  # noqa: E402
from flow import SKIPPED, Flow, Server, check  # noqa: E402


class SmallDisk:
    """A file system of 48 MiB."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rigcal-disk-"))
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=48m", "tmpfs", str(self.folder)], capture_output=True, text=True)
        if done.returncode != 0:
            self.folder.rmdir()
            print("SKIPPED: may not mount a small disk: " + done.stderr.strip())
            raise SystemExit(SKIPPED)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        subprocess.run(["umount", str(self.folder)], check=True)
        self.folder.rmdir()

    def fill(self):
        with open(self.folder / "filling", "ab", buffering=0) as file:
            for size in (1 << 20, 4096, 1):
                try:
                    while file.write(b"x" * size) == size:
                        pass
                except OSError:
                    pass

    def free(self):
        (self.folder / "filling").unlink()


def ready(flow):
    """HTTP status and text."""
    try:
        with urllib.request.urlopen(flow.address + "/readyz", timeout=20) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def await_ready(flow, status):
    for _ in range(200):
        found, text = ready(flow)
        if found == status:
            return text
        flow.rigcal("robots")  # takes its time
    raise SystemExit("FAILED: /readyz stays %d: %r" % (found, text))


def reads(flow, shown):
    check(json.loads(flow.rigcal("show", "rig", "--json").stdout)["digest"] == shown["digest"], "show gives the same")
    flow.rigcal("lookup", "rig", "a", "b")
    for path in ("/", "/robots/rig/", "/robots/rig/revisions/1/", "/api/v1/robots"):
        check(flow.get(path), path + " is answered")
    text = await_ready(flow, 503)
    check("disk of the data folder" in text and text.count("\n") == 1, "one sentence: %r" % text)
    document = json.loads(flow.get("/healthz"))  # 200: it is alive
    check(document["state"] == "failing" and "disk of the data folder" in document["problem"]["what"], "health: %r" % document)
    check([part["name"] for part in document["parts"] if part["problem"]] == ["disk"], "parts: %r" % document["parts"])
    check(document["parts"][0]["since"], "since when: %r" % document["parts"][0])
    told = flow.rigcal("doctor", exit_code=1).stdout
    check("cannot store anything" in told, "doctor: " + told)
    check("cannot store anything" in flow.rigcal("status").stdout, "status")


def refuses(flow, path):
    refused = flow.rigcal("push-edges", path, "--robot", "other", exit_code=4)
    check(refused.stderr.count("\n") == 1 and "disk" in refused.stderr, "one sentence that names the disk: " + refused.stderr)


def restart(flow, disk):
    """What a server gives back when it stops is taken before the next one starts, and what that one spares."""
    flow.server.stop()
    disk.fill()
    flow.server.start()
    flow.address = flow.ready()
    disk.fill()


def main():
    flow = Flow()
    with SmallDisk() as disk:
        flow.server = Server(flow.context, disk.folder / "store")
        with flow:
            path = triangle(flow.folder)
            flow.rigcal("push-edges", path, "--robot", "rig")
            shown = json.loads(flow.rigcal("show", "rig", "--json").stdout)
            await_ready(flow, 200)
            disk.fill()
            reads(flow, shown)
            refuses(flow, path)
            disk.free()
            await_ready(flow, 200)
            for _ in range(2):
                restart(flow, disk)
                reads(flow, shown)
                refuses(flow, path)
            flow.kill_and_restart()
            reads(flow, shown)
            disk.free()
            await_ready(flow, 200)
            flow.rigcal("push-edges", path, "--robot", "other")
            check(json.loads(flow.rigcal("show", "other", "--json").stdout)["published"], "and goes on by itself")


if __name__ == "__main__":
    main()
