"""What counts, and how it is taken back. A stranger reads the manifest of a session over HTTP and sends it with squares 1.1 times
as large: in the name of another robot it must bring the pictures, in the name of the same robot it supersedes the session. The
owner pushes the right folder again, or restores it, and it counts. An edge with a typing error is retired, and pushed
again it stays so. A sensor that was taken off is retired: nobody asks for it, a session that brings it says so, and it is restored."""
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from front_rig import front_rig  # noqa: E402

ROBOT = "owner"


def send_manifest(flow, manifest):
    """Without a picture; (state, payloads held, session id)."""
    text = json.dumps(manifest, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    done = subprocess.run([str(flow.context.bin / "hostile_client"), "foreign-manifest"], input=text, capture_output=True, text=True,
                          env=dict(os.environ, **flow.server.environment()), timeout=120)
    check(done.returncode == 0, "the manifest was answered: %s%s" % (done.stdout, done.stderr))
    state, session = done.stdout.splitlines()
    return state, session


def base_mm(flow):
    T = json.loads(flow.rigcal("lookup", ROBOT, "front_left", "front_right", "--json").stdout)["T_a_b"]
    return 1e3 * sum(value * value for value in T["p_m"]) ** 0.5


def shown(flow):
    return json.loads(flow.rigcal("show", ROBOT, "--json").stdout)


def superseded(flow):
    rows = json.loads(flow.rigcal("sessions", ROBOT, "--json").stdout)["sessions"]
    return {row["session"]: row["superseded_by"]["session"] for row in rows if row["superseded_by"]}


def supersede(flow, session):
    """The right session, pushed; then the wrong one over it."""
    right = json.loads(flow.rigcal("push", session, "--json").stdout)["id"]
    true_mm = base_mm(flow)
    manifest = json.loads(flow.get("/api/v1/session?id=" + right))["manifest"]
    for target in manifest["targets"]:
        target["square_size_m"] *= 1.1
    state, stranger = send_manifest(flow, dict(manifest, robot="stranger"))
    check(state == "open: 0 payloads held", "another robot has to send the pictures: %r" % state)
    check(not json.loads(flow.get("/api/v1/session?id=" + stranger))["edges"], "and nothing came of it")
    number = shown(flow)["revision"]
    state, wrong = send_manifest(flow, manifest)
    check(state.startswith("closed: "), "the robot itself need not: %r" % state)
    flow.rigcal("restore", wrong)  # current already: only waited for
    check(shown(flow)["revision"] > number, "it became a revision, and passes")
    check(base_mm(flow) > true_mm + 5, "the calibration is wrong now: %.1f mm, right: %.1f mm" % (base_mm(flow), true_mm))
    check(superseded(flow) == {right: wrong}, "the wrong one counts: %r" % superseded(flow))
    return right, wrong, true_mm


def check_right(flow, right, wrong, true_mm, how):
    check(superseded(flow) == {wrong: right}, "%s: the right one counts: %r" % (how, superseded(flow)))
    check(abs(base_mm(flow) - true_mm) < 1e-6, "%s: the calibration is right again: %.6f and %.6f mm" % (how, base_mm(flow), true_mm))


def check_shown(flow, old, by):
    """Everywhere: which does not count, because of which, and how it is taken back."""
    command = "rigcal restore " + old[:16]
    listed = flow.rigcal("sessions", ROBOT).stdout
    check("superseded" in listed and by[:16] in listed and command in listed, "the list says so: " + listed)
    for page in ("/robots/%s/" % ROBOT, "/robots/%s/sessions/%s/" % (ROBOT, old)):
        text = flow.get(page)
        check(by[:12] in text and command in text, "%s says so" % page)


def check_sessions(flow, session):
    right, wrong, true_mm = supersede(flow, session)
    check_shown(flow, right, wrong)
    again = flow.rigcal("push", session)
    said = "Session %s is current again, pushed again on " % right[:16]
    check(said in again.stderr and wrong[:16] in again.stderr, "the push says so: " + again.stderr)
    check_right(flow, right, wrong, true_mm, "pushed again")
    number = shown(flow)["revision"]
    flow.rigcal("push", session)
    check(shown(flow)["revision"] == number, "a third push changes nothing")

    restored = flow.rigcal("restore", wrong[:8], "--reason", "to try", "--by", "Ada").stdout
    check("restored by Ada on " in restored and "(to try)" in restored, "restore says so: " + restored)
    check(superseded(flow) == {right: wrong} and base_mm(flow) > true_mm + 5, "the wrong one was restored")
    check_shown(flow, right, wrong)
    flow.rigcal("restore", right, "--no-wait")
    flow.kill_and_restart()
    flow.rigcal("restore", right)  # said before: only waited for
    check_right(flow, right, wrong, true_mm, "restored")
    number = shown(flow)["revision"]
    flow.rigcal("restore", right, "--robot", ROBOT)
    check(shown(flow)["revision"] == number, "restored twice is restored once")
    for arguments in (("restore", "01234567"), ("restore", right, "--robot", "nobody"), ("restore", "abc"),
                      ("retire", "01234567", "--reason", "x")):
        check(flow.rigcal(*arguments, exit_code=4).stderr.startswith("rigcal: "), "one sentence for %r" % (arguments,))


def edge(a, b, x_m):
    information = [[1e8 if i == j else 0.0 for j in range(6)] for i in range(6)]
    return {"frame_a": a, "frame_b": b, "T_a_b": {"p_m": [x_m, 0, 0], "q_xyzw": [0, 0, 0, 1]}, "information": information}


def level(flow):
    return json.loads(flow.get("/api/v1/show?robot=typed"))["document"]["verdict"]["level"]


def check_edges(flow):
    files = {"good": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.0)], "typo": [edge("a", "c", 12.0)]}
    for name, edges in files.items():
        (flow.folder / (name + ".json")).write_text(json.dumps({"format": 1, "edges": edges}))
    flow.rigcal("push-edges", flow.folder / "good.json", "--robot", "typed")
    good = level(flow)
    check(flow.server.rigcal("push-edges", flow.folder / "typo.json", "--robot", "typed").returncode != 0, "the robot does not pass")
    check(level(flow) != good, "because of the wrong edge: %s" % good)
    rows = json.loads(flow.rigcal("edges", "typed", "--json").stdout)["edges"]
    wrong = [row["id"] for row in rows if row["T_a_b"]["p_m"][0] == 12.0][0]
    check(wrong[:12] in flow.rigcal("edges", "typed").stdout, "the ids are listed")
    text = flow.rigcal("retire", wrong[:12], "--reason", "typed 12 for 2", "--by", "Ada").stdout
    check("retired on 20" in text and " by Ada: " in text and "typed 12 for 2" in text, "retire says so: " + text)
    check(level(flow) == good, "the robot is as it was: %s" % level(flow))
    past = flow.rigcal("edges", "typed").stdout
    check("a - c: PAST\n" in past and "`rigcal restore %s`" % wrong[:16] in past, "the list says how it is brought back: " + past)
    again = flow.rigcal("push-edges", flow.folder / "typo.json", "--robot", "typed")
    check("stays retired" in again.stderr and "typed 12 for 2" in again.stderr, "pushed again it stays so: " + again.stderr)
    flow.rigcal("retire", wrong, "--reason", "again")
    flow.kill_and_restart()
    document = json.loads(flow.get("/api/v1/show?robot=typed"))["document"]
    past = [row["id"] for row in document["edges"] if row["state"] == "failed"]
    check(past == [wrong] and level(flow) == good, "after a restart too: %r" % past)


def sensors(flow):
    return [sensor["id"] for sensor in json.loads(flow.get("/api/v1/show?robot=typed"))["document"]["sensors"]]


def push_mast(flow, name, x_m):
    edges = [edge("b", "mast", x_m), edge("c", "mast", x_m - 1.0)]
    (flow.folder / name).write_text(json.dumps({"format": 1, "measured_at": "2026-01-31", "edges": edges}))
    return flow.rigcal("push-edges", flow.folder / name, "--robot", "typed")


def check_sensor(flow):
    push_mast(flow, "mast.json", 3.0)
    check(sensors(flow) == ["a", "b", "c", "mast"], "the mast is known: %r" % sensors(flow))
    retired = flow.rigcal("retire", "mast", "--robot", "typed", "--reason", "taken off", "--by", "Ada").stdout
    command = "rigcal restore mast --robot typed"
    check("Sensor mast of typed does not count any more: retired on 20" in retired and command in retired, "retire says so: " + retired)
    check(sensors(flow) == ["a", "b", "c"], "nobody asks for it: %r" % sensors(flow))
    again = push_mast(flow, "other.json", 3.00005)
    check("mast was retired on " in again.stderr and command in again.stderr, "what comes later says so: " + again.stderr)
    check(sensors(flow) == ["a", "b", "c"], "and does not count: %r" % sensors(flow))
    check(command in flow.get("/robots/typed/") and command in flow.rigcal("show", "typed").stdout, "the page and `show` say so")
    check("brings it back" in flow.rigcal("lookup", "typed", "a", "mast", exit_code=4).stderr, "lookup says so")
    refused = flow.rigcal("retire", "nobody", "--robot", "typed", "--reason", "x", exit_code=4).stderr
    check("has no sensor 'nobody'" in refused, "one that there is not: " + refused)
    flow.kill_and_restart()
    flow.rigcal("retire", "mast", "--robot", "typed", "--reason", "again")
    check(sensors(flow) == ["a", "b", "c"], "after a restart too: %r" % sensors(flow))
    restored = flow.rigcal("restore", "mast", "--robot", "typed", "--by", "Ada").stdout
    check("Sensor mast of typed counts again, restored by Ada on " in restored, "restore says so: " + restored)
    check(sensors(flow) == ["a", "b", "c", "mast"], "it is back: %r" % sensors(flow))


def main():
    with Flow() as flow:
        rig = front_rig(flow, ROBOT, "rig")
        session = flow.folder / "session"
        flow.rigcal("simulate", rig, "--out", session, "--seed", 1, "--captures", 20, "--scale", 0.3, "--captured-at", "2026-01-31")
        check_sessions(flow, session)
        check_edges(flow)
        check_sensor(flow)
    print("standing: good")


main()
