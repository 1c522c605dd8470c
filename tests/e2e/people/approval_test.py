"""The life of a calibration. A person approves, rolls back, and whatever kills the server in between, what robots are told was approved, and
nothing else is; who decided is in an audit that holds, and names the row of which one byte was flipped."""
import hashlib
import json
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402

ROBOT = "rig"
WHY = "checked against the wall"
FAIL, REFUSED, UNKNOWN = 1, 4, 6


def push(flow, ab_m, more=(), exit_code=None):
    edges = [edge("a", "b", ab_m), edge("b", "c", 1.0), edge("a", "c", 1.0 + ab_m), *more]
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return flow.rigcal("push-edges", path, "--robot", ROBOT, exit_code=exit_code).stdout


def in_use(flow):
    """The revision that robots are told; 0: none."""
    told = flow.server.rigcal("lookup", ROBOT, "a", "b", "--json")
    if told.returncode == REFUSED:
        check("No calibration of rig is in use" in told.stderr, "lookup without an approval: " + told.stderr)
        return 0
    return json.loads(told.stdout)["revision"]


def states(flow):
    rows = json.loads(flow.rigcal("history", ROBOT, "--json").stdout)["revisions"]
    return {row["revision"]: row["state"] for row in rows}


def audit(flow):
    return json.loads(flow.rigcal("audit", ROBOT, "--json").stdout)["rows"]


def verified(flow):
    told = flow.rigcal("audit", "verify").stdout
    check(told.startswith("The audit is as it was written: "), "the audit holds: " + told)


def nothing_runs_unapproved(flow):
    policy = flow.folder / "policy.yaml"
    policy.write_text("approval: person\n")
    flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
    push(flow, 1.0)
    check(in_use(flow) == 0 and states(flow) == {1: "candidate"}, "nobody approved it: %r" % states(flow))
    flow.kill_and_restart()
    check(in_use(flow) == 0 and states(flow) == {1: "candidate"}, "nor did a restart: %r" % states(flow))
    told = flow.rigcal("show", ROBOT).stdout
    check("No calibration of rig is in use; this one is a candidate: `rigcal approve rig 1 --reason TEXT`" in told, "show says so: " + told)
    check("rigcal approve rig 1 --reason TEXT" in flow.get("/robots/rig/"), "and the page")
    refused = flow.rigcal("approve", ROBOT, "--reason", WHY, exit_code=REFUSED).stderr
    check("revision 1 is the newest candidate, `rigcal approve rig 1 --reason TEXT`" in refused, "what nobody looked at is not approved: " + refused)
    check("the policy itself decides" in flow.rigcal("approve", ROBOT, 1, "--reason", WHY, "--by", "policy", exit_code=REFUSED).stderr, "nobody poses as the policy")
    said = flow.rigcal("approve", ROBOT, 1, "--reason", WHY, "--by", "Ada").stdout
    check(said == "Revision 1 of rig was approved by Ada: %s. It is in use now.\n" % WHY, "approve: " + said)
    flow.kill_and_restart()
    check(in_use(flow) == 1, "an answered approval is on disk")


def a_newer_one_waits(flow):
    push(flow, 1.0002)
    check(in_use(flow) == 1 and states(flow) == {2: "candidate", 1: "approved"}, "the second waits: %r" % states(flow))
    check(re.search(r"In use: revision 1 \(approved by Ada, \d+ \w+ 20\d\d\); this one is a candidate", flow.rigcal("show", ROBOT).stdout), "show says what is in use")
    check("A candidate: revision 1 is in use." in flow.rigcal("status", ROBOT).stdout, "so does status")
    flow.rigcal("approve", ROBOT, 2, "--reason", WHY)
    check(in_use(flow) == 2, "the second is in use")
    sheet = flow.folder / "certificate.pdf"
    said = flow.rigcal("certificate", ROBOT, "--revision", 1, "--out", sheet).stdout
    check("superseded, no certificate of rig, revision 1, one page of A4" in said, "what another took the place of: " + said)
    said = flow.rigcal("certificate", ROBOT, "--out", sheet).stdout
    check(": Calibration certificate of rig, revision 2, one page of A4" in said, "the certificate: " + said)
    told = subprocess.run(["pdftotext", "-layout", sheet, "-"], capture_output=True, text=True).stdout if shutil.which("pdftotext") else None
    check(told is None or ("approved by" in told and "Signature" in told and "page 1 of 1" in told), "its text: %s" % told)
    page = flow.get("/robots/rig/revisions/1/certificate.html")
    check("superseded, no certificate" in page and 'class="signature"' not in page, "and its page: " + page)
    check(sheet.read_bytes().startswith(b"%PDF-") and len(re.findall(rb"/Type /Page\b", sheet.read_bytes())) == 1, "it is one page")
    flow.kill_and_restart()
    said = flow.rigcal("rollback", ROBOT, 1, "--reason", "the floor was soft", "--by", "Eve").stdout
    check("was rolled back to revision 1 by Eve: the floor was soft. It is in use now." in said, "rollback: " + said)
    flow.kill_and_restart()
    check(in_use(flow) == 1 and states(flow) == {2: "rolled_back", 1: "approved"}, "rolled back: %r" % states(flow))


def agent(flow, exit_code=0, timeout_s=60):
    return flow.rigcal("agent", ROBOT, "--out", flow.folder / "calibration.json", "--once", "--json", "--timeout", timeout_s, exit_code=exit_code)


def trouble(flow, wanted):
    """What the server says of what the robot runs: it hears it a moment later."""
    until = time.monotonic() + 60
    while time.monotonic() < until:
        told = json.loads(flow.server.rigcal("show", ROBOT, "--json").stdout)["runs"]
        if told is not None and wanted in (told["trouble"] or "none"):
            return told
    check(False, "what the robot runs: %r instead of %s" % (told, wanted))


def a_robot_applies_it(flow):
    """Revision 1 is in use, 2 was rolled back."""
    file = flow.folder / "calibration.json"
    told = json.loads(agent(flow).stdout)
    check(told["revision"] == 1 and told["written"], "it was applied: %r" % told)
    check(hashlib.sha256(file.read_bytes()).hexdigest() == told["digest"], "the file is the revision's document")
    flow.kill_and_restart()
    known = json.loads(flow.rigcal("show", ROBOT, "--json").stdout)["runs"]
    check(known == {"revision": 1, "digest": told["digest"], "trouble": None}, "whoever ends with 0 was heard, on disk: %r" % known)
    check(not json.loads(agent(flow).stdout)["written"], "once more is no more")
    flow.rigcal("rollback", ROBOT, 2, "--reason", "it was the wall")
    check("It runs revision 1; revision 2 is in use: not applied yet." in trouble(flow, "not applied yet")["trouble"], "the server says what is not applied")
    check("It runs revision 1; revision 2 is in use: not applied yet." in flow.get("/robots/rig/"), "so does the page")
    said = flow.rigcal("status", ROBOT, exit_code=UNKNOWN).stdout
    check(said.startswith("Not applied: the robot runs revision 1; revision 2 is in use.\n"), "nobody may drive by it: " + said)
    flow.kill_and_restart()
    check(json.loads(agent(flow).stdout)["revision"] == 2, "then it is")
    trouble(flow, "none")
    flow.rigcal("reject", ROBOT, 2, "--reason", "no")
    flow.rigcal("reject", ROBOT, 1, "--reason", "no")
    kept = file.read_bytes()
    said = agent(flow, exit_code=REFUSED, timeout_s=3).stderr
    check("no calibration of robot 'rig' is in use" in said and "no candidate" in said, "nothing is announced: " + said)
    check("the robot runs revision 2, which was rejected by " in flow.rigcal("status", ROBOT, exit_code=UNKNOWN).stdout, "what it runs was rejected")
    check("nobody goes back to it" in flow.rigcal("rollback", ROBOT, 2, "--reason", "no", exit_code=REFUSED).stderr, "nor is it rolled back to")
    check(file.read_bytes() == kept, "the file stays as it is")
    file.write_text("{}")
    agent(flow, exit_code=REFUSED, timeout_s=3)
    check("It runs a calibration that nobody approved here" in trouble(flow, "nobody approved here")["trouble"], "a stranger's file is told")
    flow.rigcal("approve", ROBOT, 1, "--reason", "after all")
    check(json.loads(agent(flow).stdout)["revision"] == 1, "and replaced")


def refusals(flow):
    push(flow, 1.0, more=[edge("a", "c", 5.0)], exit_code=FAIL)
    check("verdict fail" in flow.rigcal("approve", ROBOT, max(states(flow)), "--reason", WHY, exit_code=REFUSED).stderr, "a fail is not approved")
    check("no revision 9" in flow.rigcal("rollback", ROBOT, 9, "--reason", WHY, exit_code=REFUSED).stderr, "nor what there is not")
    check(in_use(flow) == 1, "what was in use is")


def kills(flow):
    """Wherever the kill falls, the decision is whole or was never made."""
    flow.rigcal("approve", ROBOT, 2, "--reason", "the second look")
    for go in range(6):
        before = in_use(flow), len(audit(flow))
        wanted = 3 - before[0]
        client = subprocess.Popen(flow.server.client("rollback", ROBOT, wanted, "--reason", "try %d" % go), env=flow.server.environment(),
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            client.wait(timeout=0.02 * go + 0.01)
        except subprocess.TimeoutExpired:
            pass
        flow.server.kill()
        client.kill()
        client.wait()
        flow.kill_and_restart()
        after = in_use(flow), len(audit(flow))
        check(after in (before, (wanted, before[1] + 1)), "kill %d: from %r to %r" % (go, before, after))
        verified(flow)


def digests(flow):
    rows = json.loads(flow.rigcal("history", ROBOT, "--json").stdout)["revisions"]
    return {row["revision"]: row["digest"] for row in rows}


def the_same_calibration_twice():
    """An epoch that was begun and taken back leaves the same document under another number: a no to one is a no to both."""
    with Flow() as flow:
        policy = flow.folder / "policy.yaml"
        policy.write_text("approval: person\n")
        flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
        push(flow, 1.0)
        flow.rigcal("approve", ROBOT, 1, "--reason", WHY, "--by", "Ada")
        flow.rigcal("epoch", ROBOT, "--sensor", "b", "--reason", "a new bracket", exit_code=UNKNOWN)
        flow.rigcal("epoch", ROBOT, "--sensor", "b", "--take-back", "--reason", "the old one")
        same = digests(flow)
        twin = max(same)
        check(twin > 1 and same[twin] == same[1], "the newest is the first once more: %r" % same)
        check(in_use(flow) == 1, "the first is in use")
        flow.rigcal("reject", ROBOT, twin, "--reason", "the bracket is bent", "--by", "Eve")
        for _ in range(2):
            check(in_use(flow) == 0, "neither is in use")
            told = states(flow)
            check(told[1] == told[twin] == "rejected", "both are rejected: %r" % told)
            flow.kill_and_restart()
        refused = flow.rigcal("rollback", ROBOT, 1, "--reason", WHY, exit_code=REFUSED).stderr
        check("is the same calibration as revision %d, which was rejected by Eve" % twin in refused, "nobody goes back to it: " + refused)
        decided = [(row["what"].split()[0], row["digest"]) for row in audit(flow) if row["digest"]]
        check(decided == [("rejected", same[1]), ("approved", same[1])], "the audit tells of what: %r" % decided)
        check(same[1][:12] in flow.rigcal("audit").stdout, "to people, too")
        flow.rigcal("approve", ROBOT, 1, "--reason", "it was the floor")
        check(in_use(flow) == 1, "a later word holds")
        flow.rigcal("reject", ROBOT, twin, "--reason", "it was not")
        check(in_use(flow) == 0, "and one after that")
        verified(flow)


def a_row_put_in(flow):
    """What decides stands in another table than the audit."""
    flow.server.kill()
    with sqlite3.connect(flow.server.data / "rigcal.db") as database:
        database.execute("INSERT INTO decision (robot_id, revision_number, how, at_ns, who, reason) VALUES ('rig', 1, 'approved', 5, 'policy', 'the verdict is pass')")
    database.close()
    flow.kill_and_restart()
    told = flow.rigcal("audit", "verify", exit_code=1).stdout
    check(re.search(r"decision \d+ \(approved revision 1 of robot rig, by policy\) has no audit row: rigcald did not write it", told), "it is named: " + told)


def a_flipped_byte(flow):
    """One bit, in the file itself."""
    row = next(one for one in audit(flow) if one["what"] == "approved revision 2 of robot rig: " + WHY)
    flow.server.kill()
    store = flow.server.data / "rigcal.db"
    with sqlite3.connect(store) as database:
        database.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    database.close()
    stored = store.read_bytes()
    text = row["what"].encode()
    check(text in stored, "the row stands in the file")
    store.write_bytes(stored.replace(text, text.replace(b"wall", b"wal" + bytes([ord("l") ^ 1]))))  # in unused pages too
    flow.kill_and_restart()
    told = flow.rigcal("audit", "verify", exit_code=1).stdout
    check(re.match(r"The audit does not hold: audit row %d of \d+ \w+ 20\d\d was changed, or one before it is missing\." % row["number"], told), "it is named: " + told)


def main():
    with Flow() as flow:
        nothing_runs_unapproved(flow)
        a_newer_one_waits(flow)
        a_robot_applies_it(flow)
        refusals(flow)
        verified(flow)
        kills(flow)
        a_row_put_in(flow)
        a_flipped_byte(flow)
    the_same_calibration_twice()
    print("approval: good")


main()
