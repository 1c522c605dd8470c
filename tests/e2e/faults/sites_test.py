"""A site's server and its centre, real processes on DDS networks of their own and TLS between them: what robots push at the site is at the
centre with the same ids and, once computed, the same poses; no kill of either loses or doubles anything; without a centre the site works on."""
import json
import pathlib
import shutil
import socket
import sqlite3
import ssl
import sys
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from edges_files import block_edges  # noqa: E402
from flow import Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402
from made_certificate import make_certificate  # noqa: E402

PATIENCE_S = 120


class Centre(Flow):
    """Over TLS, at a port that stays."""

    def __init__(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        super().__init__()
        self.certificate, key = make_certificate(self.folder, "centre")
        self.arguments = ("--http", "127.0.0.1:%d" % self.port, "--http-cert", str(self.certificate), "--http-key", str(key))

    def get(self, path):
        with urllib.request.urlopen(self.address + path, timeout=20, context=ssl.create_default_context(cafile=str(self.certificate))) as reply:
            return reply.read().decode()

    def token(self, name, *arguments):
        file = self.folder / (name + ".token")
        file.touch(mode=0o600)
        file.write_text(self.rigcal("token", "new", name, "--role", "site", "--data", self.server.data, *arguments).stdout)
        return file

    def options(self, token, ca=None):
        return ("--centre", "https://localhost:%d" % self.port, "--centre-token-file", str(token), "--centre-ca", str(ca or self.certificate))


def state_of(site):
    return json.loads(site.get("/api/v1/centre"))


def await_state(site, is_so, what):
    until = time.monotonic() + PATIENCE_S
    while not is_so(state_of(site)):
        check(time.monotonic() < until, "%s: %r" % (what, state_of(site)))


def await_all_sent(site):
    await_state(site, lambda state: state["sessions_waiting"] + state["batches_waiting"] == 0, "all is sent")


def rows(flow, sql):
    with sqlite3.connect("file:%s/rigcal.db?mode=ro" % flow.server.data, uri=True) as database:
        return sorted(database.execute(sql).fetchall())


def same_at_both(site, centre):
    """Ids, contents and whose they are, row by row; each once, as the tables' keys have it."""
    for sql in ("SELECT session_id, robot_id, manifest FROM session s JOIN session_closed c ON c.session_number = s.number",
                "SELECT s.session_id, p.idx, p.digest FROM payload_held h JOIN payload p USING (session_number, idx) JOIN session s ON s.number = p.session_number",
                "SELECT b.batch_id, b.robot_id, b.item_count, i.idx, e.edge_id FROM batch b JOIN batch_item i ON i.batch_number = b.number "
                "JOIN edge e ON e.number = i.edge_number",
                "SELECT edge_id, T_a_b_x_m, T_a_b_qx, information, dof, source FROM edge e JOIN counted_edge c ON c.edge_number = e.number WHERE e.session_id IS NULL"):
        here, there = rows(site, sql), rows(centre, sql)
        check(here and here == there, "the same at both: %d and %d rows of %s" % (len(here), len(there), sql))
    for (digest,) in rows(site, "SELECT DISTINCT digest FROM payload"):
        blob = pathlib.Path("blobs") / digest[:2] / digest
        check((site.server.data / blob).read_bytes() == (centre.server.data / blob).read_bytes(), "blob " + digest)


def visit(site, robot, seed, captures):
    folder = site.folder / ("%s-%d" % (robot, seed))
    site.rigcal("simulate", front_rig(site, robot, robot), "--out", folder, "--seed", seed, "--captures", captures, "--scale", 0.25, "--captured-at", "2026-01-31")
    return folder


def edges_of(site, robot, x_m, count=1):
    path = site.folder / ("%s-%s.json" % (robot, x_m))
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b%d" % i, x_m + i) for i in range(count)]}))
    site.rigcal("push-edges", path, "--robot", robot, "--new-robot", "--no-wait")


def same_poses(site, centre, robot):
    wait_published(site)
    wait_published(centre)
    here, there = (json.loads(flow.rigcal("show", robot, "--json").stdout)["document"] for flow in (site, centre))
    check([one["id"] for one in here["edges"]] == [one["id"] for one in there["edges"]], "the same edges of " + robot)
    check(here["sensors"] == there["sensors"], "the same poses of %s: %r and %r" % (robot, here["sensors"], there["sensors"]))


def goes_through(site, centre):
    site.rigcal("push", visit(site, "harbour-1", 1, 8), "--new-robot")
    site.rigcal("push-edges", block_edges(site.folder / "blocks.json", 150, 4), "--robot", "harbour-2", "--new-robot", "--no-wait")
    await_all_sent(site)
    same_at_both(site, centre)
    same_poses(site, centre, "harbour-1")
    same_poses(site, centre, "harbour-2")
    check(site.get("/metrics").count("rigcal_forward_waiting 0\n") == 1, "the figures say that nothing waits")


def in_use(flow, robot):
    told = flow.server.rigcal("lookup", robot, "a", "b0", "--json")
    return 0 if told.returncode == 4 else json.loads(told.stdout)["revision"]


def approved_comes_back(site, centre):
    """A person decides at the centre; the robots of the site are told it by the site's server."""
    for flow in (site, centre):
        policy = flow.folder / "policy.yaml"
        policy.write_text("approval: person\n")
        flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
    edges_of(site, "harbour-5", 1.0)
    await_all_sent(site)
    wait_published(site)
    wait_published(centre)
    check(in_use(site, "harbour-5") == 0 and in_use(centre, "harbour-5") == 0, "nobody approved it yet")
    centre.rigcal("approve", "harbour-5", "1", "--by", "Ada", "--reason", "checked against the wall")
    until = time.monotonic() + PATIENCE_S
    while in_use(site, "harbour-5") == 0:
        check(time.monotonic() < until, "what is approved at the centre is in use at the site")
    row = json.loads(site.rigcal("audit", "harbour-5", "--json").stdout)["rows"][0]
    check(row["who"] == "Ada at the centre" and "checked against the wall" in row["what"], "the audit of the site says whose word it is: %r" % row)
    site.rigcal("reject", "harbour-5", "1", "--by", "Eve", "--reason", "the mast is bent")
    edges_of(site, "harbour-6", 1.0)
    await_all_sent(site)
    check(in_use(site, "harbour-5") == 0, "a later word at the site holds")


def outlives_kills(site, centre):
    """Each is killed while something is under way; both have all of it in the end."""
    first = visit(site, "harbour-3", 3, 3)
    for i in range(4):
        folder = site.folder / ("kill-%d" % i)
        shutil.copytree(first, folder)
        yaml = (folder / "session.yaml").read_text().replace("robot: harbour-3", "robot: harbour-kill-%d" % i)
        (folder / "session.yaml").write_text(yaml)
        site.rigcal("push", folder, "--new-robot", "--no-wait")
        edges_of(site, "harbour-kill-%d" % i, 1.0 + i)
        (site if i % 2 else centre).kill_and_restart()
    await_all_sent(site)
    same_at_both(site, centre)


def works_on_alone(site, centre):
    centre.server.kill()
    edges_of(site, "harbour-1", 7.0)
    await_state(site, lambda state: state["failing_since"], "the site says that the centre is away")
    state = state_of(site)
    check(state["batches_waiting"] == 1 and "no answer from the centre" in state["last_error"], "and why: %r" % state)
    check("Not at the centre https://localhost" in site.get("/") and "rigcal_forward_failing 1\n" in site.get("/metrics"), "the pages say it")
    check(site.get("/readyz") == "ready\n", "a site without its centre is well")
    centre.server.start(*centre.arguments)
    centre.address = centre.ready()
    await_all_sent(site)
    same_at_both(site, centre)


def gets_back_what_it_lost(site, centre):
    """The centre's folder is put back to an older state: what it had confirmed since is sent to it again."""
    old = centre.folder / "older"
    centre.server.stop()
    shutil.copytree(centre.server.data, old)
    centre.server.start(*centre.arguments)
    centre.address = centre.ready()
    site.rigcal("push", visit(site, "harbour-7", 7, 3), "--new-robot", "--no-wait")
    edges_of(site, "harbour-7", 2.0)
    await_all_sent(site)
    centre.server.kill()
    edges_of(site, "harbour-8", 2.0)
    await_state(site, lambda state: state["failing_since"], "the site says that the centre is away")
    shutil.rmtree(centre.server.data)
    old.rename(centre.server.data)
    centre.server.start(*centre.arguments)
    centre.address = centre.ready()
    await_all_sent(site)
    same_at_both(site, centre)


def restart(site, *arguments):
    site.server.stop()
    site.arguments = arguments
    site.server.start(*arguments)
    site.address = site.ready()


def refused(site, centre):
    wrong = site.folder / "wrong.token"
    wrong.touch(mode=0o600)
    wrong.write_text("0" * 64 + "\n")
    others = centre.token("elsewhere", "--robots", "elsewhere-*")
    good, stranger = site.arguments, make_certificate(site.folder, "stranger")[0]
    for options, why in ((centre.options(wrong), "this takes the token of a site, and none that is good was sent"),
                         (centre.options(site.token, stranger), "certificate"),
                         (centre.options(others), "is none of the site elsewhere, whose token is of robots elsewhere-*")):
        restart(site, *options)
        edges_of(site, "harbour-1", 10.0 + len(why))
        await_state(site, lambda state: why in (state["last_error"] or ""), "why nothing arrives, once it was tried anew: " + why)
        check(site.get("/readyz") == "ready\n", "the site goes on working")
    check(not rows(centre, "SELECT 1 FROM batch WHERE robot_id LIKE 'elsewhere%'"), "and nothing came of it")
    restart(site, *good)
    await_all_sent(site)
    same_at_both(site, centre)


def will_not_start(site, centre):
    open_token = site.folder / "open.token"
    open_token.write_text("0" * 64)
    open_token.chmod(0o644)
    for arguments, why in ((centre.options(open_token), "others on this machine can read"),
                           (("--centre", "http://rigs.example.org", "--centre-token-file", site.token), "unprotected"),
                           (("--centre", "https://localhost"), "has no --centre-token-file")):
        site.server.stop()
        site.server.start(*map(str, arguments))
        check(site.server.process.wait(timeout=60) == 1, "it ends: " + why)
        site.server.close()
        said = pathlib.Path(str(site.server.data) + ".log").read_text().splitlines()[-1]
        check(why in said, "%s: %s" % (why, said))


def main():
    with Centre() as centre:
        site = Flow()
        site.token = centre.token("harbour", "--robots", "harbour-*")
        site.arguments = centre.options(site.token)
        with site:
            goes_through(site, centre)
            approved_comes_back(site, centre)
            outlives_kills(site, centre)
            works_on_alone(site, centre)
            gets_back_what_it_lost(site, centre)
            refused(site, centre)
            will_not_start(site, centre)
    print("sites: good")


main()
