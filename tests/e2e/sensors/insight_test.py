"""A pushed graph with one wrong edge: document, text and page hold influence and loops, and name that edge."""
import itertools
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

SENSORS = {"front": (0.0, 0.0, 0.0), "left": (0.0, 0.5, 0.1), "right": (0.1, -0.5, 0.0), "rear": (-0.8, 0.0, 0.2), "top": (-0.3, 0.1, 0.9)}
SIGMA_M, SIGMA_RAD = 0.001, 0.002
WRONG = ("left", "rear")
OFF_M, OFF_RAD = 0.03, math.radians(2.0)


def edge(a, b, off_m, off_rad):
    """No sensor is turned, so poses differ by their positions alone; small errors that depend on the names."""
    noise = [SIGMA_M * (((len(a) * 7 + len(b) * 3 + axis * 5) % 9) / 9.0 - 0.5) for axis in range(3)]
    p_m = [SENSORS[b][axis] - SENSORS[a][axis] + noise[axis] for axis in range(3)]
    p_m[0] += off_m
    information = [[(1 / SIGMA_M**2 if row < 3 else 1 / SIGMA_RAD**2) if row == column else 0.0 for column in range(6)] for row in range(6)]
    return {"frame_a": a, "frame_b": b, "information": information,
            "T_a_b": {"p_m": p_m, "q_xyzw": [0.0, 0.0, math.sin(off_rad / 2), math.cos(off_rad / 2)]}}


def graph(folder, off):
    edges = [edge(a, b, *((OFF_M, OFF_RAD) if off and (a, b) == WRONG else (0.0, 0.0))) for a, b in itertools.combinations(SENSORS, 2)]
    path = folder / ("off.json" if off else "good.json")
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return path


def document_of(flow, robot, exit_code):
    return json.loads(flow.rigcal("show", robot, "--json", exit_code=exit_code).stdout)["document"]


def check_wrong(document):
    cycles, wrong = document["cycles"], [one for one in document["edges"] if (one["frame_a"], one["frame_b"]) == WRONG][0]
    # Ten triangles in a complete graph of five; the wrong edge is in three, and each is off by what it is off.
    check((cycles["examined"], cycles["tested"], cycles["failing"]) == (10, 10, 3), "loops: %r" % cycles)
    for place, loop in enumerate(cycles["worst"]):
        check(loop["fails"] == (wrong["id"] in loop["edges"]), "loop %d: %r" % (place, loop))
        check(loop["fails"] == (place < 3), "failing loops come first")
    for loop in cycles["worst"][:3]:
        check(abs(math.hypot(*loop["e"][3:]) - OFF_RAD) < 1e-9, "rotation of the loop: %r" % loop["e"])
        check(loop["t_squared"] > loop["limit"] > 20, "T^2 of the loop: %r" % loop)
    check(document["influence"]["judged"], "influence is worked out")
    most = max(document["edges"], key=lambda one: one["influence"]["move_sigmas"])
    check(most["id"] == wrong["id"], "the wrong edge moves most: %s - %s" % (most["frame_a"], most["frame_b"]))
    check(wrong["influence"]["sensor"] in WRONG, "of its own sensors: %r" % wrong["influence"])
    suspects = [one["edge"] for one in document["suspects"]["edges"]]
    check(suspects == [wrong["id"]], "the suspect is the wrong edge")


def main():
    with Flow() as flow:
        flow.rigcal("push-edges", graph(flow.folder, False), "--robot", "good")
        flow.rigcal("push-edges", graph(flow.folder, True), "--robot", "bad", exit_code=1)
        good = document_of(flow, "good", 0)
        check(good["cycles"]["failing"] == 0 and good["cycles"]["examined"] == 10, "good loops close: %r" % good["cycles"])
        check_wrong(document_of(flow, "bad", 1))

        text = flow.rigcal("show", "bad", exit_code=1).stdout
        check("Loops: 10 worked out, 10 tested, 3 do not close" in text, "the text counts loops: " + text)
        influence = text[text.index("Influence"):]
        check(influence.splitlines()[2].startswith("left - rear"), "the text names the edge first: " + influence)

        page = flow.get("/robots/bad/revisions/1/")
        check('id="loops"' in page and "3 do not close." in page, "the page has its loops")
        check(page.count("does not close</span>") == 3, "failing loops are marked")
        check("Without the edge" in page and "left &rarr; rear" in page, "the page has the influence of edges")
        check("do not close" not in flow.get("/robots/good/revisions/1/"), "a good robot's page marks none")
    print("insight: good")


main()
