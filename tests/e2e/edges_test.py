"""Finished edges: pushed in two orders to two servers, queried, again after kill -9."""
import json

from flow import Flow, check

IDENTITY = [[1e6 if row == column else 0.0 for column in range(6)] for row in range(6)]


def edge(a, b, x_m):
    return {"frame_a": a, "frame_b": b, "T_a_b": {"p_m": [x_m, 0.0, 0.0], "q_xyzw": [0.0, 0.0, 0.0, 1.0]}, "information": IDENTITY}


def triangle(folder):
    path = folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    return path


def newest(flow):
    return json.loads(flow.rigcal("show", "rig", "--json").stdout)


def main():
    with Flow() as flow, Flow() as other:
        path = triangle(flow.folder)
        flow.rigcal("push-edges", path, "--robot", "rig")
        other.rigcal("push-edges", path, "--robot", "rig", "--shuffle", 7)
        shown = newest(flow)
        check(shown["digest"] == newest(other)["digest"], "the order of arrival does not change the revision")

        looked_up = json.loads(flow.rigcal("lookup", "rig", "b", "c", "--json").stdout)
        # A triangle with equal weights shares its 3 mm closure: a third on each edge.
        check(abs(looked_up["T_a_b"]["p_m"][0] - 1.001) < 1e-9, "lookup b c: %r" % looked_up["T_a_b"])
        # Two thirds of the edge's own variance (1e-6): (N_V - 1) / N_E.
        check(abs(looked_up["covariance"][0][0] / 1e-6 - 2 / 3) < 1e-3, "variance of b c: %r" % looked_up["covariance"][0][0])

        again = json.loads(flow.rigcal("push-edges", path, "--robot", "rig", "--json").stdout)
        check(again["held_before"] == 3, "pushing again sends nothing: %r" % again)
        check(newest(flow)["revision"] == shown["revision"], "pushing again makes no revision")

        flow.kill_and_restart()
        check(newest(flow) ["document"] == shown["document"], "the revision survives kill -9")
        check(json.loads(flow.get("/api/v1/show?robot=rig"))["digest"] == shown["digest"], "HTTP gives the same document")
        check("rig" in flow.get("/"), "the fleet page lists the robot")
        check("<svg" in flow.get("/robots/rig/revisions/%d/" % shown["revision"]), "the report has a drawing")
        flow.rigcal("due", "--max-age", "90d")
        flow.rigcal("doctor")
    print("edges: good")


main()
