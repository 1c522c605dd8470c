"""DDS with identities, from the command line that makes them to the report: who pushes, who decides, who is refused."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check, wait_published  # noqa: E402
from measures.sessions import noise_session  # noqa: E402


class Fleet:
    """An authority, and the environment of whoever has one of its identities."""
    def __init__(self, flow, name):
        self.flow, self.folder = flow, flow.folder / name

    def make(self, *arguments, exit_code=0):
        done = subprocess.run(self.flow.server.client("identity", *arguments, "--authority", self.folder), capture_output=True, text=True, timeout=60)
        check(done.returncode == exit_code, "rigcal identity %s: exit %d: %s%s" % (" ".join(arguments), done.returncode, done.stdout, done.stderr))
        return done

    def rigcal(self, who, *arguments, exit_code=0):
        """`who`: a folder of an identity below that of the fleet; None: without any. `exit_code` None: any."""
        identity = {} if who is None else {"RIGCAL_DDS_IDENTITY": str(self.folder / who)}
        done = subprocess.run(self.flow.server.client(*arguments), capture_output=True, text=True, timeout=120, env={**self.flow.server.environment(), **identity})
        check(exit_code in (None, done.returncode), "%s: rigcal %s: exit %d instead of %r: %s%s" % (
            who, " ".join(map(str, arguments)), done.returncode, exit_code, done.stdout, done.stderr))
        return done


TAKEN_UP = "the files of the server's identity changed"


def wait_until(is_so, flow, what, within_s=30):
    end = time.monotonic() + within_s
    while not is_so():
        check(time.monotonic() < end, what)
        flow.get("/api/v1/live")


def log_of(flow):
    return pathlib.Path(str(flow.server.data) + ".log").read_text()


def made_on_the_command_line(fleet):
    check("the server" in fleet.make("init").stdout, "the first is the server's")
    fleet.make("init", exit_code=4)
    for words in (("robot", "rig"), ("robot", "other"), ("operator", "ada"), ("operator", "bob", "--days", "30"),
                  ("operator", "ben", "--role", "technician"), ("operator", "vera", "--role", "viewer")):
        fleet.make("new", *words)
    fleet.make("new", "robot", "rig", exit_code=4)
    fleet.make("new", "server", "another", exit_code=4)
    rows = json.loads(fleet.make("list", "--json").stdout)["identities"]
    check([(row["holder"], row["name"], row["role"], row["state"]) for row in rows] == [
        ("server", "rigcald", "", "good"), ("robot", "other", "", "good"), ("robot", "rig", "", "good"), ("operator", "ada", "approver", "good"),
        ("operator", "ben", "technician", "good"), ("operator", "bob", "approver", "good"), ("operator", "vera", "viewer", "good")], "the list: %r" % rows)
    for key in ("ca.key", "permissions-ca.key", "server/identity.key", "robots/rig/identity.key"):
        check((fleet.folder / key).stat().st_mode & 0o777 == 0o600, key + " is its user's alone")


def pushed(flow, fleet):
    """From the wire to the report."""
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    fleet.rigcal("robots/rig", "push-edges", path, "--robot", "rig")
    session = noise_session(flow.folder / "session", "other", 300_000, 8, seed=7)
    told = json.loads(fleet.rigcal("operators/ada", "push", session, "--no-wait", "--json").stdout)
    check(told["items"] == 8, "a technician pushes for a robot: %r" % told)
    wait_published(flow)
    check("revision 1" in flow.get("/robots/rig/").lower(), "the robot has its page")
    check("<main" in flow.get("/robots/rig/revisions/1/"), "and its report")
    check(json.loads(fleet.rigcal("robots/rig", "robots", "--json").stdout)["robots"], "the robot reads it back")
    check("no identity" not in flow.get("/"), "pages do not warn")
    told = fleet.rigcal("operators/bob", "doctor", "--json", exit_code=None).stdout
    check([one["level"] for one in json.loads(told)["checks"] if one["name"] == "identity"] == ["warn"], "30 days are soon over: " + told)
    return path


def strangers(flow, fleet, path):
    fleet.rigcal(None, "robots", "--timeout", "3", exit_code=3)
    fleet.rigcal(None, "push-edges", path, "--robot", "rig", "--timeout-total", "3", exit_code=3)
    foreign = Fleet(flow, "foreign")
    foreign.make("init")
    foreign.make("new", "robot", "rig")
    foreign.rigcal("robots/rig", "push-edges", path, "--robot", "rig", "--timeout-total", "3", exit_code=3)


def as_another(fleet, path):
    told = fleet.rigcal("robots/other", "push-edges", path, "--robot", "rig", exit_code=4).stderr
    check("the identity of robot other does not let it" in told, "it is told why: " + told)
    shutil.copytree(fleet.folder / "robots/other", fleet.folder / "robots/mixed")
    shutil.copy(fleet.folder / "robots/rig/permissions.p7s", fleet.folder / "robots/mixed/permissions.p7s")
    fleet.rigcal("robots/mixed", "push-edges", path, "--robot", "rig", exit_code=4)
    shutil.rmtree(fleet.folder / "robots/mixed")
    check("is no server's" in started_as(fleet, "robots/rig"), "nor is a robot a server")


def signed_by(identity, text):
    """As whoever holds `identity` can sign what it may do."""
    done = subprocess.run(["openssl", "smime", "-sign", "-text", "-signer", identity / "identity.pem", "-inkey", identity / "identity.key"],
                          input=text, check=True, capture_output=True)
    return done.stdout


def text_in(document):
    return subprocess.run(["openssl", "smime", "-verify", "-noverify", "-text", "-in", document], check=True, capture_output=True).stdout


def forged(fleet, path):
    """The robot `other` grants itself what the server and the robot `rig` are granted, and makes its own folder take that."""
    own = fleet.folder / "robots/forged"
    shutil.copytree(fleet.folder / "robots/other", own)
    grants = text_in(own / "permissions.p7s").replace(b">robot/other<", b">robot/*<")
    check(b">robot/*<" in grants, "it is forged")
    (own / "permissions.p7s").write_bytes(signed_by(own, grants))
    fleet.rigcal("robots/forged", "push-edges", path, "--robot", "rig", exit_code=4)
    (own / "governance.p7s").write_bytes(signed_by(own, text_in(own / "governance.p7s")))
    shutil.copy(own / "ca.pem", own / "permissions-ca.pem")
    fleet.rigcal("robots/forged", "push-edges", path, "--robot", "rig", "--timeout-total", "5", exit_code=3)
    shutil.rmtree(own)


def started_as(fleet, who):
    data = fleet.flow.folder / "impostor"
    done = subprocess.run([str(fleet.flow.context.bin / "rigcald"), "--data", str(data), "--http", "127.0.0.1:0", "--dds-identity", str(fleet.folder / who)],
                          capture_output=True, text=True, timeout=60, env=fleet.flow.server.environment())
    check(done.returncode == 1, "it ends: %d" % done.returncode)
    return done.stderr


def orders(fleet):
    told = fleet.rigcal("robots/rig", "reject", "rig", "1", "--reason", "x", exit_code=4).stderr
    check("was asked by a robot" in told, "a robot decides nothing: " + told)
    told = fleet.rigcal("operators/ada", "reject", "rig", "1", "--reason", "x", "--by", "bob", exit_code=4).stderr
    check("came with the identity of operator ada" in told, "nor anybody as somebody else: " + told)
    session = noise_session(fleet.flow.folder / "of-vera", "other", 1000, 1, seed=8)
    fleet.rigcal("operators/vera", "push", session, "--no-wait", exit_code=4)
    for who, role in (("vera", "viewer"), ("ben", "technician")):
        fleet.rigcal("operators/" + who, "robots")
        told = fleet.rigcal("operators/" + who, "reject", "rig", "1", "--reason", "x", exit_code=4).stderr
        check("the identity of %s, %s, does not let them reject" % (who, role) in told, "a role decides what it may: " + told)
    fleet.rigcal("operators/ada", "reject", "rig", "1", "--reason", "a mount is loose")
    rows = json.loads(fleet.rigcal("operators/bob", "audit", "--json").stdout)["rows"]
    who = [row["who"] for row in rows if "rejected revision 1" in row["what"]]
    check(who == ["ada (over DDS, verified)"], "the audit has who it was: %r" % rows)


def expired(fleet, path):
    folder = fleet.folder / "robots/rig"
    request = subprocess.run(["openssl", "req", "-new", "-key", folder / "identity.key", "-subj", "/OU=robot/CN=rig"], check=True, capture_output=True).stdout
    shutil.copytree(folder, fleet.folder / "robots/late")
    (fleet.folder / "robots/late/identity.pem").write_bytes(subprocess.run(
        ["openssl", "x509", "-req", "-CA", fleet.folder / "ca.pem", "-CAkey", fleet.folder / "ca.key", "-CAcreateserial", "-CAserial", fleet.flow.folder / "serial",
         "-days", "-1"], input=request, check=True, capture_output=True).stdout)
    told = fleet.rigcal("robots/late", "push-edges", path, "--robot", "rig", exit_code=4).stderr
    check("expired at" in told, "it is told why: " + told)


def revoked(flow, fleet):
    fleet.make("revoke", "operator", "bob")
    rows = json.loads(fleet.make("list", "--json").stdout)["identities"]
    check([row["state"] for row in rows if row["name"] == "bob"] == ["revoked"], "the list says so: %r" % rows)
    os.remove(fleet.folder / "operators/bob/revoked.crl")  # whoever keeps the identity keeps no list
    wait_until(lambda: log_of(flow).count(TAKEN_UP) == 1, flow, "the server takes up the list by itself")
    fleet.rigcal("operators/ada", "robots")
    told = fleet.rigcal("operators/bob", "robots", "--timeout", "4", exit_code=3).stderr
    check("its log says whom it refuses" in told, "it is told where to look: " + told)
    lines = [line for line in log_of(flow).splitlines() if "certificate revoked" in line]
    check(lines and len(lines) <= 4 and "CN=bob" in lines[0].replace(" ", ""), "the log says whom it refuses, not every second: %r" % lines)


def revoked_while_it_listens(flow, fleet):
    """Who is met already hears and says nothing more: `watch` is told no revision, although the others go on. At once: SIGHUP."""
    arguments = flow.server.client("watch", "rig", "--json")
    environment = {**flow.server.environment(), "RIGCAL_DDS_IDENTITY": str(fleet.folder / "robots/rig")}
    heard = flow.folder / "heard"
    with heard.open("wb") as out:
        listener = subprocess.Popen(arguments, stdout=out, stderr=subprocess.DEVNULL, env=environment)
    try:
        before = heard.stat().st_size
        for verb in ("retire", "restore") * 10:  # what is decided before it has met the server is not told again
            fleet.rigcal("operators/ada", verb, "c", "--robot", "rig", "--reason", "to be heard", "--no-wait")
            if verb == "retire" and heard.stat().st_size > before:
                break
        wait_until(lambda: heard.stat().st_size > before, flow, "it listens")
        taken_up = log_of(flow).count(TAKEN_UP)
        fleet.make("revoke", "robot", "rig")
        os.kill(flow.server.process.pid, signal.SIGHUP)
        wait_until(lambda: log_of(flow).count(TAKEN_UP) == taken_up + 1, flow, "the server takes up the list")
        before = heard.stat().st_size
        fleet.rigcal("operators/ada", "restore", "c", "--robot", "rig", "--reason", "it is there", "--no-wait")
        wait_published(flow)
        check(heard.stat().st_size == before, "who is revoked hears nothing more")
    finally:
        listener.kill()
        listener.wait()


def heard_across_a_reload(flow, fleet):
    """Who listened before all of DDS is opened anew hears what happens until it is met again: each revision."""
    environment = {**flow.server.environment(), "RIGCAL_DDS_IDENTITY": str(fleet.folder / "operators/ada")}
    heard = flow.folder / "heard-by-ada"

    def revisions():
        return {event["data"]["revision"] for event in map(json.loads, heard.read_text().splitlines()) if event["kind"] == "revision"}

    def newest():
        return json.loads(fleet.rigcal("operators/ada", "show", "rig", "--json", exit_code=None).stdout)["revision"]

    with heard.open("wb") as out:
        listener = subprocess.Popen(flow.server.client("watch", "rig", "--json"), stdout=out, stderr=subprocess.DEVNULL, env=environment)
    try:
        for verb in ("retire", "restore") * 10:  # until it has met the server
            fleet.rigcal("operators/ada", verb, "c", "--robot", "rig", "--reason", "to be heard", "--no-wait")
            wait_published(flow)
            if verb == "restore" and revisions():
                break
        before = newest()
        fleet.make("revoke", "operator", "ben")
        os.kill(flow.server.process.pid, signal.SIGHUP)
        fleet.rigcal("operators/ada", "retire", "c", "--robot", "rig", "--reason", "while it is away", "--no-wait")
        fleet.rigcal("operators/ada", "restore", "c", "--robot", "rig", "--reason", "while it is away", "--no-wait")
        fleet.make("new", "operator", "cleo")
        fleet.make("revoke", "operator", "cleo")
        os.kill(flow.server.process.pid, signal.SIGHUP)  # once more, before what was kept is told
        wait_until(lambda: newest() > before and newest() in revisions(), flow, "what was made of the robot meanwhile is heard")
        check(log_of(flow).count(TAKEN_UP) == 3, "all of DDS was opened anew, twice")
    finally:
        listener.kill()
        listener.wait()


def older_list(flow, fleet):
    """A copy of before, over the list in force: who was revoked since stays out, and the log says why."""
    place = fleet.folder / "server/revoked.crl"
    newer, older = place.read_bytes(), (flow.folder / "first.crl").read_bytes()
    place.write_bytes(older)
    wait_until(lambda: "before the list in force" in log_of(flow), flow, "the log says that the list is older")
    (fleet.folder / "operators/bob/revoked.crl").unlink(missing_ok=True)
    fleet.rigcal("operators/bob", "robots", "--timeout", "4", exit_code=3)
    taken_up = log_of(flow).count(TAKEN_UP)
    place.write_bytes(newer)
    wait_until(lambda: log_of(flow).count(TAKEN_UP) == taken_up + 1, flow, "the one in force is taken up again")


def torn(flow, fleet):
    """A list that is none is told, and that of before holds."""
    place = fleet.folder / "server/revoked.crl"
    os.remove(fleet.folder / "operators/bob/revoked.crl")
    whole = place.read_bytes()
    place.write_bytes(whole[:len(whole) // 2])
    wait_until(lambda: "that of before stays" in log_of(flow), flow, "the log says that the list is none")
    fleet.rigcal("operators/ada", "robots")
    fleet.rigcal("operators/bob", "robots", "--timeout", "4", exit_code=3)
    place.write_bytes(whole)


def without(flow):
    """On a network, and told to nobody who they are: the server says so."""
    flow.server.stop()
    apart = flow.server.environment()
    flow.server.environment = lambda: {**apart, "RIGCAL_DDS_LOCAL": ""}
    flow.server.start()
    flow.address = flow.ready()
    if "over DDS nobody logs in" not in log_of(flow):
        print("SKIPPED: a server without identities warns: this machine has no network")
        return
    for page in ("/", "/boards/"):
        check("it has no identity" in flow.get(page), page + " says it")


def main():
    flow = Flow()
    fleet = Fleet(flow, "fleet")
    try:
        made_on_the_command_line(fleet)
        flow.arguments = ("--dds-identity", str(fleet.folder / "server"))
        flow.server.start(*flow.arguments)
        flow.address = flow.ready()
        path = pushed(flow, fleet)
        strangers(flow, fleet, path)
        as_another(fleet, path)
        forged(fleet, path)
        orders(fleet)
        expired(fleet, path)
        shutil.copy(fleet.folder / "server/revoked.crl", flow.folder / "first.crl")
        revoked(flow, fleet)
        heard_across_a_reload(flow, fleet)
        older_list(flow, fleet)
        revoked_while_it_listens(flow, fleet)
        torn(flow, fleet)
        without(flow)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("identities: good")


main()
