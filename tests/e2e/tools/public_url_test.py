"""Where the reports are, as a robot is told it: the address that the server was given, not the one that it listens at."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import Flow, check  # noqa: E402

URL = "https://rigs.example.org/rigcal"


def told_everywhere(flow):
    flow.server.start("--public-url", URL + "/")
    line = flow.server.process.stdout.readline()
    check("reports at %s/ " % URL in line, "the server says it: " + line)
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    pushed = flow.rigcal("push-edges", path, "--robot", "rig").stdout
    check("report  %s/robots/rig/revisions/1/\n" % URL in pushed, "the push ends with it: " + pushed)
    status = json.loads(flow.rigcal("status", "--json").stdout)
    check(status["http_address"] == URL, "status: %r" % status["http_address"])
    check("reports at %s/\n" % URL in flow.rigcal("status").stdout, "status in words")
    flow.server.stop()


def main():
    flow = Flow()
    try:
        told_everywhere(flow)
        flow.server.start("--public-url", "rigs.example.org")
        flow.server.process.wait(timeout=60)
        check(flow.server.process.returncode == 1, "no URL: exit %r" % flow.server.process.returncode)
        flow.server.stop()
        said = (flow.folder / "store.log").read_text()
        check('the public address "rigs.example.org" is not one' in said, "no URL: " + said)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("public_url: good")


main()
