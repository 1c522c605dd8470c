"""Users and tokens over a real rigcald with TLS, with curl: who reads, who decides, what ends a session, what the audit says."""
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402
from made_certificate import make_certificate  # noqa: E402

PASSWORD = "correct horse battery"


class Browser:
    """curl with a jar of its own."""
    def __init__(self, flow, certificate, name):
        self.address, self.certificate, self.jar = flow.address, certificate, flow.folder / (name + ".jar")

    def ask(self, path, *arguments):
        """(status, head, body)"""
        done = subprocess.run(["curl", "-sS", "-i", "--max-time", "30", "--cacert", str(self.certificate), "-b", str(self.jar), "-c", str(self.jar),
                               *arguments, self.address + path], capture_output=True, text=True)
        check(done.returncode == 0, "curl %s: %s" % (path, done.stderr))
        head, _, body = done.stdout.partition("\n\n") if "\r\n\r\n" not in done.stdout else done.stdout.partition("\r\n\r\n")
        return int(head.split()[1]), head, body

    def status(self, path, *arguments):
        return self.ask(path, *arguments)[0]

    def form(self):
        return re.search('name="form" value="([0-9a-f]{64})"', self.ask("/login")[2]).group(1)

    def log_in(self, name, password, origin=None):
        fields = ["--data-urlencode", "name=" + name, "--data-urlencode", "password=" + password, "--data-urlencode", "form=" + self.form()]
        return self.status("/login", "-H", "Origin: " + (origin or self.address), *fields)

    def order(self, verb, parameters, token=None, form=None):
        who = ["-H", "Authorization: Bearer " + token] if token else ["-H", "Origin: " + self.address, "-H", "X-Rigcal-Form: " + (form or "")]
        return self.ask("/api/v1/" + verb, "-H", "Content-Type: application/json", "-d", json.dumps(parameters), *who)


def keep(flow, *arguments, said="", exit_code=0):
    """`rigcal user` and `rigcal token` on the server's folder."""
    done = subprocess.run(flow.server.client(*arguments, "--data", flow.server.data), input=said, capture_output=True, text=True,
                          env=flow.server.environment(), timeout=120)
    check(done.returncode == exit_code, "rigcal %s: exit %d: %s%s" % (" ".join(arguments), done.returncode, done.stdout, done.stderr))
    return done


def push_robot(flow):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    flow.rigcal("push-edges", path, "--robot", "rig")


def made_on_the_command_line(flow):
    keep(flow, "user", "add", "ada", "--role", "approver", said="short\n", exit_code=4)
    keep(flow, "user", "add", "ada", "--role", "approver", "--by", "grace", said=PASSWORD + "\n")
    keep(flow, "user", "add", "ada", "--role", "admin", said=PASSWORD + "\n", exit_code=4)
    keep(flow, "user", "add", "vic", "--role", "viewer", said=PASSWORD + "\n")
    users = json.loads(keep(flow, "user", "list", "--json").stdout)["users"]
    check([(one["name"], one["role"]) for one in users] == [("ada", "approver"), ("vic", "viewer")], "users: %r" % users)
    for name in ("rigcal.db", "rigcal.db-wal"):
        stored = flow.server.data / name
        check(not stored.exists() or PASSWORD.encode() not in stored.read_bytes(), "no password is stored")
        check(not stored.exists() or stored.stat().st_mode & 0o777 == 0o600, "%s is the user's alone" % name)
    check(flow.server.data.stat().st_mode & 0o777 == 0o700, "and so is the data folder")


def in_a_mistyped_folder(flow):
    """Nobody believes that the user was let in at the server that serves."""
    done = subprocess.run(flow.server.client("user", "list", "--data", flow.folder / "mistyped"), capture_output=True, text=True, env=flow.server.environment(), timeout=60)
    check(done.returncode == 0 and "There was no store in %s: a new one was made." % (flow.folder / "mistyped") in done.stderr, "it is said: " + done.stderr)
    check("no store" not in keep(flow, "user", "list").stderr, "and only there")


def strangers(flow, browser):
    for path in ("/", "/robots/rig/", "/metrics", "/api/v1/status", "/robots/rig/revisions/1/", "/due.ics"):
        check(browser.status(path) == 401, "a stranger does not read " + path)
    status, head, _ = browser.ask("/robots/rig/", "-H", "Accept: text/html")
    check(status == 303 and "/login?next=/robots/rig/" in head, "a browser is led to the login: " + head)
    for path in ("/healthz", "/readyz", "/style.css", "/login"):
        check(browser.status(path) == 200, "everybody reads " + path)


def people(flow, certificate):
    ada, vic = Browser(flow, certificate, "ada"), Browser(flow, certificate, "vic")
    check(ada.log_in("ada", "wrong wrong wrong") == 403, "a wrong password is none")
    check(ada.log_in("ada", PASSWORD, origin="https://localhost:1") == 403, "nor is a form of another page")
    check(ada.log_in("ada", PASSWORD) == 303 and vic.log_in("vic", PASSWORD) == 303, "they log in")
    jar = ada.jar.read_text()
    check("#HttpOnly_" in jar and "__Host-rigcal-" in jar, "a cookie for no script: " + jar)
    check("ada, approver" in ada.ask("/")[2], "the page says who it is")
    for path in ("/robots/rig/", "/robots/rig/revisions/1/", "/metrics", "/api/v1/status"):
        check(vic.status(path) == 200, "a viewer reads " + path)
    decision = {"robot": "rig", "revision": 1, "reason": "a mount is loose"}
    check(vic.order("reject", decision, form=vic.form())[0] == 403, "a viewer decides nothing")
    check(ada.order("reject", decision)[0] == 403, "nor does a page that has not the form's token")
    check(ada.order("reject", {**decision, "who": "eve"}, form=ada.form())[0] == 400, "nor anybody as somebody else")
    status, _, body = ada.order("reject", decision, form=ada.form())
    check(status == 200, "an approver does: %d %s" % (status, body))
    check(json.loads(flow.rigcal("status", "--json").stdout)["robots"][0]["robot"] == "rig", "the robot is told")
    check(ada.order("set_policy", {"text": "tolerance_mm: 4", "reason": "x"}, form=ada.form())[0] == 403, "and sets no policy")
    return ada, vic


def programs(flow, certificate):
    program = Browser(flow, certificate, "program")
    token = keep(flow, "token", "new", "grafana", "--role", "viewer").stdout.strip()
    admin = keep(flow, "token", "new", "ops", "--role", "admin").stdout.strip()
    check(program.status("/metrics", "-H", "Authorization: Bearer " + token) == 200, "a program reads with its token")
    check(program.order("set_policy", {"text": "tolerance_mm: 4", "reason": "x"}, token=token)[0] == 403, "as a viewer it sets nothing")
    status, _, body = program.order("set_policy", {"text": "tolerance_mm: 4", "reason": "new mounts"}, token=admin)
    check(status == 200, "as admin it does: %d %s" % (status, body))
    nested = program.ask("/api/v1/resolve", "-H", "Authorization: Bearer " + admin, "-H", "Content-Type: application/json", "-d", '{"id":%s%s}' % ("[" * 10000, "]" * 10000))
    check(nested[0] == 400, "nested deep it is refused: %r" % (nested,))
    check(program.status("/healthz") == 200, "and the server goes on")
    keep(flow, "token", "revoke", "grafana")
    check(program.status("/metrics", "-H", "Authorization: Bearer " + token) == 401, "revoked it is nobody")


def orders_over_dds(flow):
    """Nobody logs in there: the name is kept as what it is, said by somebody."""
    flow.rigcal("retire", "c", "--robot", "rig", "--by", "ada", "--reason", "it was not me")
    row = json.loads(flow.rigcal("audit", "--json").stdout)["rows"][0]
    check(row["who"] == "ada (over DDS, not verified)", "the audit says that nobody verified it: %r" % row)


def sessions_end(flow, ada, vic):
    old = ada.jar.read_text()
    form = ada.form()
    check(ada.status("/logout", "-H", "Origin: " + ada.address, "--data-urlencode", "form=" + form) == 303, "she logs out")
    ada.jar.write_text(old)
    check(ada.status("/") == 401, "a cookie of before is nobody's")
    keep(flow, "user", "password", "vic", said="another long password\n")
    check(vic.status("/") == 401, "nor is one of an older password")
    check(vic.log_in("vic", "another long password") == 303, "the new one lets him in")
    keep(flow, "user", "remove", "vic")
    check(vic.status("/") == 401, "nor of somebody who is gone")


def flood(flow, certificate):
    eve = Browser(flow, certificate, "eve")
    answers = [eve.log_in("ada", "guess number %d" % number) for number in range(12)]
    check(answers[0] == 403 and answers[-1] == 429, "guesses are slowed down: %r" % answers)


def audited(flow):
    rows = [(row["who"], row["what"]) for row in json.loads(flow.rigcal("audit", "--json").stdout)["rows"]]
    for who, what in (("grace", "added user ada as approver"), ("ada", "rejected revision 1"), ("ops", "set version 1 of the policy")):
        check(any(row[0] == who and what in row[1] for row in rows), "the audit has that %s %s: %r" % (who, what, rows))
    check(json.loads(flow.rigcal("audit", "verify", "--json").stdout)["chain_holds"], "and holds")


def beyond_this_machine(flow, certificate, key):
    """0.0.0.0 with TLS is for those who log in: where there is nobody, it does not start."""
    flow.server.stop()
    keep(flow, "user", "remove", "ada")
    flow.server.start("--http", "0.0.0.0:0", "--http-cert", str(certificate), "--http-key", str(key))
    flow.server.process.wait(timeout=60)
    check(flow.server.process.returncode == 1, "without a user it ends: %r" % flow.server.process.returncode)
    flow.server.stop()
    check("there is no user" in pathlib.Path(str(flow.server.data) + ".log").read_text().splitlines()[-1], "and says why")
    keep(flow, "user", "add", "ada", "--role", "viewer", said=PASSWORD + "\n")
    apart = flow.server.environment()
    flow.server.environment = lambda: {**apart, "RIGCAL_DDS_LOCAL": ""}
    flow.server.start("--http", "0.0.0.0:0", "--http-cert", str(certificate), "--http-key", str(key))
    flow.address = "https://127.0.0.1:" + flow.ready().rsplit(":", 1)[1]
    check("over DDS nobody logs in" in pathlib.Path(str(flow.server.data) + ".log").read_text(), "and warns of DDS, which the network reaches")
    keep(flow, "user", "remove", "ada")
    check(Browser(flow, certificate, "last").status("/") == 401, "nor does the last one's going open it")


def main():
    flow = Flow()
    certificate, key = make_certificate(flow.folder, "rigs")
    try:
        flow.server.start("--http-cert", str(certificate), "--http-key", str(key))
        flow.address = flow.ready()
        push_robot(flow)
        stranger = Browser(flow, certificate, "stranger")
        check(stranger.status("/") == 200, "without users everybody on this machine reads")
        made_on_the_command_line(flow)
        in_a_mistyped_folder(flow)
        strangers(flow, stranger)
        ada, vic = people(flow, certificate)
        programs(flow, certificate)
        orders_over_dds(flow)
        sessions_end(flow, ada, vic)
        flood(flow, certificate)
        audited(flow)
        beyond_this_machine(flow, certificate, key)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("logins: good")


main()
