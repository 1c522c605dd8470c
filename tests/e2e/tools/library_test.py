"""librigcal and rigcal for Python as they are installed: the examples built and run against a real rigcald, and what they must not do."""
import json
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import IDENTITY, edge  # noqa: E402
from flow import ROOT, Flow, check  # noqa: E402
from front_rig import front_rig  # noqa: E402

BUILD = pathlib.Path(os.environ["RIGCAL_BUILD"])
PUSHED = re.compile(r"batch ([0-9a-f]{64}): 3 edges, (\d) were there before\nrevision 1: warn\. OK to drive.*\nc is 1\.0010 m in front of b, sigma 0\.82 mm\n")


def output(*command, **more):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True, timeout=300, **more).stdout


def install(prefix):
    """As the three packages have it."""
    for component in ("library", "development", "python"):
        output("cmake", "--install", BUILD, "--component", component, "--prefix", prefix)
    os.environ["RIGCAL_LIBRARY"] = str(prefix / "lib/librigcal.so.0")
    sys.path.insert(0, str(prefix / "lib/python3/dist-packages"))
    shown = {line.split()[2] for line in output("nm", "-D", "--defined-only", prefix / "lib/librigcal.so").splitlines()}
    wanted = set(re.findall(r"^RIGCAL_API .*?\b(rigcal_\w+)\(", (prefix / "include/rigcal/c_api.h").read_text(), re.MULTILINE))
    check(shown == wanted, "what the library shows: %r" % (shown ^ wanted))
    check((prefix / "lib/python3/dist-packages/rigcal/py.typed").exists(), "the package is typed")


def build(prefix):
    """By CMake's package, and one program by pkg-config. Where they are."""
    examples, built = prefix / "share/doc/librigcal-dev/examples", prefix / "built"
    output("cmake", "-S", examples, "-B", built, "-DCMAKE_PREFIX_PATH=%s" % prefix)
    output("cmake", "--build", built)
    flags = output("pkg-config", "--cflags", "--libs", "rigcal", env={**os.environ, "PKG_CONFIG_PATH": str(prefix / "lib/pkgconfig")}).split()
    output("c++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-pedantic", examples / "follow.cc", "-o", built / "follow_by_pkg_config", *flags)
    return built


class Examples:
    def __init__(self, flow, prefix):
        self.cpp, self.python = build(prefix), prefix / "share/doc/python3-rigcal/examples"
        self.environment = {**flow.server.environment(), "LD_LIBRARY_PATH": str(prefix / "lib"),
                            "PYTHONPATH": str(prefix / "lib/python3/dist-packages")}

    def commands(self, name, *arguments):
        """The same example in both languages."""
        return [[str(self.cpp / name), *map(str, arguments)], [sys.executable, str(self.python / (name + ".py")), *map(str, arguments)]]

    def run(self, command):
        return output(*command, env=self.environment)

    def start(self, command):
        return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=self.environment)


def edges(examples):
    for command, robot in zip(examples.commands("push_edges"), ("by-cpp", "from-python")):
        for held_before in "03":
            said = examples.run([*command, robot])
            told = PUSHED.fullmatch(said)
            check(told and told.group(2) == held_before, "%s says %s" % (command, said))


def session(flow, examples):
    visit = flow.folder / "visit"
    flow.rigcal("simulate", front_rig(flow, "walker", "rig"), "--out", visit, "--seed", 1, "--captures", 6, "--scale", 0.25)
    said = [examples.run(command) for command in examples.commands("push_session", visit)]
    pushed = json.loads(flow.rigcal("push", visit, "--json").stdout)
    verdict = pushed["show"]["document"]["verdict"]["level"]
    for text in said:
        check(text.startswith("session %s: %d files\nrevision 1: %s." % (pushed["id"], pushed["items"], verdict)), "as the verb: %s" % text)


def fleet(flow, examples):
    said = output(*examples.commands("fleet", flow.address)[1], env={**examples.environment, "RIGCAL_LIBRARY": "/nowhere"})
    check(re.search(r"^by-cpp: OK to drive.*\n  a, b, c\n", said, re.MULTILINE), "the fleet, without librigcal: " + said)


def lines(revision, b_m):
    return ["revision %d a in a 0.000000 0.000000 0.000000\n" % revision, "revision %d b in a %.6f 0.000000 0.000000\n" % (revision, b_m),
            "revision %d c in a 2.000000 0.000000 0.000000\n" % revision]


def follow(flow, client, examples):
    """What is in use, what is approved, and that nothing is in use any more; not what merely arrived."""
    push = lambda b_m: client.push_edge_document("followed", {"format": 1, "edges": [edge("a", "b", b_m), edge("b", "c", 2.0 - b_m), edge("a", "c", 2.0)]})
    push(1.0)
    commands = [*examples.commands("follow", "followed", 3), [str(examples.cpp / "follow_by_pkg_config"), "followed", "3"]]
    running = [examples.start(command) for command in commands]
    expect = lambda wanted: [check(told == wanted, "told %r instead of %r" % (told, wanted)) for told in [[one.stdout.readline() for _ in wanted] for one in running]]
    expect(lines(1, 1.0))
    policy = flow.folder / "policy.yaml"
    policy.write_text("approval: person\n")
    flow.rigcal("policy", "set", policy, "--reason", "people ride on it")
    push(1.0004)
    newest = client.show("followed")
    check(newest["state"] == "candidate", "it waits for a person: %r" % newest["state"])
    flow.kill_and_restart()
    flow.rigcal("approve", "followed", newest["revision"], "--reason", "checked")
    shown = {row["id"]: row["T_ref_sensor"]["p_m"][0] for row in newest["document"]["sensors"]}
    expect(lines(newest["revision"], shown["b"]))
    for row in reversed(client.ask("revisions", robot="followed", limit=20)["revisions"]):  # the oldest first: none is left to go back to
        if row["state"] in ("approved", "superseded"):
            client.ask("reject", robot="followed", revision=row["revision"], who="e2e", reason="the mast was bent")
    expect(["no calibration is in use\n"])
    check([one.wait(timeout=60) for one in running] == [0, 0, 0], "they end well")


def refusal(rigcal, code, call, *words):
    try:
        call()
    except rigcal.RigcalError as error:
        check(error.code == code and all(word in str(error) for word in words) and "\n" not in str(error), "%s: %s" % (error.code, error))
        return
    check(False, "refused with %s" % code)


def refusals(flow, rigcal, client):
    refusal(rigcal, "not_found", lambda: client.show("nobody"), "nobody")
    refusal(rigcal, "conflict", lambda: client.push_edges("by-cp", [rigcal.Edge("a", "b", rigcal.Pose(), information=IDENTITY)]), "by-cpp", "new-robot")
    refusal(rigcal, "conflict", lambda: client.lookup("followed", "a", "b"), "No calibration of followed is in use")
    refusal(rigcal, "invalid_input", lambda: client.push_edges("by-cpp", [rigcal.Edge("a", "b", rigcal.Pose())]), "information")
    refusal(rigcal, "not_found", lambda: client.push_session(flow.folder / "missing"), "missing")
    refusal(rigcal, "unreachable", lambda: rigcal.Server("http://127.0.0.1:9").robots(), "127.0.0.1:9")
    refusal(rigcal, "not_found", lambda: rigcal.Server(flow.address).show("nobody"), "nobody")
    closed = rigcal.Client(tag=flow.server.tag)
    closed.close()
    closed.close()
    refusal(rigcal, "invalid_input", closed.robots, "closed")


def both_ways(flow, rigcal, client):
    """HTTP and DDS tell the same, and ids are those of docs/ids.md."""
    for robot in ("by-cpp", "from-python"):
        over_http, over_dds = rigcal.Server(flow.address).lookup(robot, "b", "c"), client.lookup(robot, "b", "c")
        check(over_http.T_a_b == over_dds.T_a_b and over_http.standing == over_dds.standing, "the same: %r, %r" % (over_http, over_dds))
    recipe = {}
    exec(re.search(r"```python\n(.*?)```", (ROOT / "docs/ids.md").read_text(), re.DOTALL).group(1), recipe)
    for batch in json.loads((ROOT / "tests/golden/ids.json").read_text())[:1]:
        pushed = client.push_edge_document(batch["robot"], {"format": 1, "edges": batch["edges"]}, wait=False)
        stored = [row["id"] for row in client.ask("edges", robot=batch["robot"])["edges"]]
        check((pushed.id, stored) == (batch["batch_id"], recipe["edge_ids"](batch["robot"], batch["edges"])), "ids: %s, %r" % (pushed.id, stored))
    doubted = client.push_edges("far", [rigcal.Edge("a", "b", rigcal.Pose((800.0, 0.0, 0.0)), information=IDENTITY)], wait=False)
    check("millimetres" in doubted.remarks and doubted.standing.revision == 0, "what looks odd is told: %r" % doubted)


def main():
    with Flow() as flow:
        os.environ.update(flow.server.environment())
        prefix = flow.folder / "prefix"
        install(prefix)
        import rigcal
        examples = Examples(flow, prefix)
        edges(examples)
        session(flow, examples)
        fleet(flow, examples)
        with rigcal.Client(tag=flow.server.tag, timeout_s=20) as client:
            follow(flow, client, examples)
            both_ways(flow, rigcal, client)
            refusals(flow, rigcal, client)
    print("library: good")


main()
