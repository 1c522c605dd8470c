"""A file of a stored session that is gone, empty or cut short and that nobody has missed yet: no receipt says that it is there, neither of the
same session, nor of another with that file, nor to a site that sends it on; each asks for it, and then it is there."""
import hashlib
import json
import pathlib
import shutil
import sys
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from measures.sessions import noise_session  # noqa: E402

BYTES = 20_000
NOT_FOUND = 404


def push(flow, folder):
    """How many bytes travelled."""
    told = json.loads(flow.rigcal("push", folder, "--new-robot", "--no-wait", "--json").stdout)
    return told["total"] - told["held_before"]


def cut(path, size):
    if size is None:
        path.unlink()
    else:
        with path.open("r+b") as file:
            file.truncate(size)


def pushed_again(flow, folder, blob, size):
    whole = blob.read_bytes()
    check(push(flow, folder) == 0, "what is there does not travel again")
    cut(blob, size)
    check(push(flow, folder) == BYTES, "the file that is cut to %r is asked for" % size)
    check(blob.read_bytes() == whole, "and is there again")


class Site:
    """What a site's server asks its centre."""

    def __init__(self, flow):
        token = flow.rigcal("token", "new", "harbour", "--role", "site", "--data", flow.server.data)
        self.address, self.token = flow.address + "/api/v1/forward", token.stdout.strip()

    def ask(self, method, path, body=None):
        request = urllib.request.Request(self.address + path, body, {"Authorization": "Bearer " + self.token}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as reply:
                return reply.status
        except urllib.error.HTTPError as error:
            return error.code


def sent_on(flow, session, digest, blob):
    site, whole = Site(flow), blob.read_bytes()
    of_session, of_blob = "/sessions/" + session, "/sessions/%s/blobs/%s" % (session, digest)
    check([site.ask("GET", path) for path in (of_session, of_blob)] == [200, 200], "the centre has it")
    blob.unlink()
    check(site.ask("GET", of_session) == NOT_FOUND, "a session without one of its files is not all there")
    check(site.ask("PUT", of_blob, whole) == 200 and blob.read_bytes() == whole, "what is sent again is kept")
    check(site.ask("GET", of_session) == 200, "and then the session is whole")
    cut(blob, 0)
    check(site.ask("PUT", of_blob, whole) == 200 and blob.read_bytes() == whole, "also where nothing was asked before")
    cut(blob, BYTES - 1)
    check(site.ask("GET", of_blob) == NOT_FOUND, "a file that is cut short is not there")
    check(site.ask("PUT", of_blob, whole) == 200 and site.ask("GET", of_blob) == 200, "until it is sent")


def main():
    with Flow() as flow:
        session = noise_session(flow.folder / "session", "mapper-01", BYTES, 6, 7)
        digest = hashlib.sha256((session / "left" / "00001.png").read_bytes()).hexdigest()
        blob = flow.server.data / "blobs" / digest[:2] / digest
        check(push(flow, session) == 6 * BYTES, "all of it travels")
        for size in (None, 0, BYTES - 1):
            pushed_again(flow, session, blob, size)
        cut(blob, 0)
        other = flow.folder / "other"
        shutil.copytree(session, other)
        header = other / "session.yaml"
        header.write_text(header.read_text().replace("12:00:00", "13:00:00"))
        check(push(flow, other) == BYTES, "of another session with these files the one that is empty travels")
        check(push(flow, session) == 0, "which mends the first")
        first = json.loads(flow.rigcal("sessions", "mapper-01", "--json").stdout)["sessions"][-1]["session"]
        sent_on(flow, first, digest, blob)
        check(flow.rigcal("fsck", flow.server.data, exit_code=0), "nothing is damaged")
    print("held files: good")


main()
