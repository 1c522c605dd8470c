"""What is wrong gets one sentence with a cure and the right exit code; the server serves on."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from measures.sessions import noise_session  # noqa: E402


def refused(flow, words, *arguments, exit_code=4):
    done = flow.rigcal(*arguments, exit_code=exit_code)
    for word in words:
        check(word in done.stderr, "'%s' is named in: %s" % (word, done.stderr))


def with_yaml(folder, change):
    session = noise_session(folder, "robot", 1000, 4, seed=3)
    yaml = session / "session.yaml"
    yaml.write_text(change(yaml.read_text()))
    return session


def bad_sessions(flow):
    place = flow.folder
    refused(flow, ["session.yaml"], "push", place / "nowhere")
    refused(flow, ["line", "sensors"], "push", with_yaml(place / "one", lambda text: text.replace("sensors:", "sensor:")))
    refused(flow, ["square"], "push", with_yaml(place / "two", lambda text: text.replace("0.025", "-1")))
    refused(flow, ["1x6", "corners"], "push", with_yaml(place / "three", lambda text: text.replace("[9, 6]", "[1, 6]")))
    renamed = noise_session(place / "four", "robot", 1000, 4, seed=4)
    (renamed / "left" / "00000.png").write_bytes(b"plain text")
    refused(flow, ["00000.png"], "push", renamed)
    linked = noise_session(place / "five", "robot", 1000, 4, seed=5)
    (linked / "left" / "99999.png").symlink_to(pathlib.Path("/etc/hostname"))
    refused(flow, ["99999.png"], "push", linked)


def bad_edges(flow):
    path = flow.folder / "bad.json"
    edge = {"frame_a": "a", "frame_b": "b", "T_a_b": {"p_m": [0, 0, 0], "q_xyzw": [0, 0, 0, 2]}, "information": [[0] * 6] * 6}
    path.write_text(json.dumps({"format": 1, "edges": [edge]}))
    refused(flow, ["q_xyzw"], "push-edges", path, "--robot", "robot")
    g2o = flow.folder / "bad.g2o"
    diagonal = "-1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1"
    g2o.write_text("EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 %s\n" % diagonal)
    refused(flow, ["line 1"], "push-edges", g2o, "--robot", "robot")


def main():
    with Flow() as flow:
        bad_sessions(flow)
        bad_edges(flow)
        refused(flow, ["nobody"], "show", "nobody")
        refused(flow, [], "show", exit_code=2)
        refused(flow, [], "no-such-verb", exit_code=2)
        noise = noise_session(flow.folder / "noise", "noise", 1000, 4, seed=6)
        flow.rigcal("push", noise)
        document = json.loads(flow.rigcal("show", "noise", "--json").stdout)["document"]
        check(document["edges"][0]["state"] == "failed", "pictures that cannot be read give a failed edge")
        check(document["edges"][0]["diagnoses"][0]["cure"], "with a cure")
        check(document["verdict"]["level"] in ("unknown", "warn"), "and no good verdict: %r" % document["verdict"])
        flow.rigcal("status")
        flow.server.stop()
        refused(flow, ["rigcald"], "status", "--timeout", "0.5", exit_code=3)
        flow.server.start()
        flow.ready()
    print("refusals: good")


main()
