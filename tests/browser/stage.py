"""A server with something on every page, and the browser's script beside it."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "e2e"))
from flow import SKIPPED, Flow, check, wait_published  # noqa: E402,F401
from measures.sessions import noise_session, picture_session  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
HOSTILE = '<script>window.ran=1</script>"\'><img src=x onerror=window.ran=1> \u05e9\u05dc\u05d5\u05dd ' + "long " * 30


def chromium():
    return os.environ.get("RIGCAL_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")


def skip_without_browser():
    modules = pathlib.Path(os.environ.get("NODE_PATH", "none"))
    for thing, missing in (("chromium", chromium() is None), ("node", shutil.which("node") is None),
                           ("playwright-core", not (modules / "playwright-core").is_dir())):
        if missing:
            print("SKIPPED: no " + thing + "; deploy/install and deploy/build bring it")
            raise SystemExit(SKIPPED)


def edge(a, b, x_m, sigma=1e-3, method="given"):
    information = [[(1 / sigma**2 if row == column else 0.0) for column in range(6)] for row in range(6)]
    return {"frame_a": a, "frame_b": b, "T_a_b": {"p_m": x_m, "q_xyzw": [0.0, 0.0, 0.0, 1.0]}, "information": information, "method": method}


def edge_file(flow, robot, edges):
    path = flow.folder / (robot + ".json")
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return path


def push_edges(flow, robot, edges, exit_code=None):
    flow.rigcal("push-edges", edge_file(flow, robot, edges), "--robot", robot, exit_code=exit_code)


def push_session(flow):
    """The real stereo pairs, with every text that a person chooses being hostile. Where there are none, files that are no
    pictures: a pair that failed. Returns whether the pictures were there."""
    pictures = flow.context.stereo_pairs()
    if not (pictures / "left01.jpg").exists():
        done = flow.server.rigcal("push", noise_session(flow.folder / "session", "stereo", 2000, 6, seed=4))
        check(done.returncode not in (2, 3, 4), "pushed: %d %s" % (done.returncode, done.stderr))
        return False
    folder = picture_session(flow.folder / "session", "stereo", pictures)
    text = (folder / "session.yaml").read_text()
    text = text.replace("right: {type: camera, sees: board}",
                        "right: {type: camera, sees: board, T_ref_nominal: {p_m: [0.085, 0, 0], q_xyzw: [0, 0, 0, 1]}}")
    text += "operator: " + json.dumps(HOSTILE) + "\nconditions: {place: " + json.dumps(HOSTILE) + ", site: " + json.dumps(HOSTILE) + "}\n"
    (folder / "session.yaml").write_text(text)
    flow.rigcal("push", folder)
    return True


def put_experiment(flow):
    folder = flow.server.data / "experiments" / "noise_whitening"
    folder.mkdir(parents=True)
    (folder / "style.css").write_text("main { max-width: 40rem; } h1 { color: rgb(1, 2, 3); }")
    (folder / "experiment.json").write_text('{"sets": 300}')
    (folder / "index.html").write_text(
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Noise</title><link rel="icon" href="data:,">'
        '<link rel="stylesheet" href="style.css"></head><body><main><h1>Noise</h1></main></body></html>')


def rover_edges(flow):
    """Of the first robot; pushing them again changes nothing."""
    return edge_file(flow, "rover", [edge("base", "front", [1, 0, 0]), edge("front", "rear", [1, 0.1, 0]), edge("base", "rear", [2.0005, 0.1, 0])])


def fill(flow):
    """Robots in every state; returns whether the pictures were there."""
    flow.rigcal("push-edges", rover_edges(flow), "--robot", "rover")
    push_edges(flow, "rover", [edge("base", "front", [1.0002, 0, 0])])
    push_edges(flow, "broken", [edge("a", "b", [1, 0, 0]), edge("b", "c", [1, 0, 0]), edge("a", "c", [2, 0, 0]), edge("a", "c", [2, 0.5, 0])], exit_code=1)
    pictures = push_session(flow)
    put_experiment(flow)
    wait_published(flow)
    return pictures


def run_script(flow, name, **facts):
    facts = {"address": flow.address, "chromium": chromium(), "scratch": str(flow.folder), **facts}
    done = subprocess.run(["node", str(HERE / name), json.dumps(facts)], capture_output=True, text=True, timeout=400,
                          env=flow.server.environment())
    print(done.stdout, end="")
    exited = flow.server.process.poll()
    check(exited is None, "rigcald ended with %r" % exited)
    check(done.returncode == 0, name + ":\n" + done.stderr[-4000:])
    return done.stdout
