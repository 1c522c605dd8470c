"""Finished edges: pushed in two orders to two servers, queried, again after kill -9."""
import json
import random

from edge_case import edge
from flow import Flow, check


def triangle(folder):
    path = folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("a", "b", 1.0), edge("b", "c", 1.0), edge("a", "c", 2.003)]}))
    return path


def newest(flow):
    return json.loads(flow.rigcal("show", "rig", "--json").stdout)


def random_g2o(path):
    """A file with as many digits as there are, and the numbers of each edge by its two vertices."""
    draw = random.Random(4)
    edges = {}
    for a in range(5):
        for b in range(a + 1, 5):
            q = [draw.gauss(0, 1e-3) for _ in range(3)] + [1.0]
            norm = sum(x * x for x in q) ** 0.5
            root = [[draw.gauss(0, 0.1) + (row == column) for column in range(6)] for row in range(6)]
            scale = [1e3 if row < 3 else 4e2 for row in range(6)]
            product = lambda r, c: scale[r] * scale[c] * sum(root[r][k] * root[c][k] for k in range(6))
            edges[a, b] = [float(b - a), draw.gauss(0, 1e-3), draw.gauss(0, 1e-3)] + [x / norm for x in q] + [
                product(r, c) for r in range(6) for c in range(r, 6)]
    path.write_text("FIX 2\n" + "".join("EDGE_SE3:QUAT %d %d %s\n" % (a, b, " ".join(map(repr, numbers)))
                                        for (a, b), numbers in edges.items()))
    return edges


def read_g2o(path):
    lines = [line.split() for line in path.read_text().splitlines()]
    return {(int(line[1]), int(line[2])): [float(x) for x in line[3:]] for line in lines if line[0] == "EDGE_SE3:QUAT"}


def g2o_round_trip(flow):
    """File to service to file, twice: what is stored is what was received."""
    sent = random_g2o(flow.folder / "sent.g2o")
    flow.server.rigcal("push-edges", flow.folder / "sent.g2o", "--robot", "ring")
    done = json.loads(flow.rigcal("export", "ring", "--out", flow.folder / "back.g2o", "--json").stdout)
    check(done["edges"] == 10 and done["sensors"] == 5, "export counts: %r" % done)
    flow.server.rigcal("push-edges", flow.folder / "back.g2o", "--robot", "ring-2")
    flow.rigcal("export", "ring-2", "--out", flow.folder / "again.g2o")
    for name in ("back.g2o", "again.g2o"):
        came = read_g2o(flow.folder / name)
        check(came.keys() == sent.keys(), name + " has every edge")
        worst = max(abs(x - y) / max(abs(x), 1.0) for pair in sent for x, y in zip(sent[pair], came[pair]))
        check(worst <= 1e-12, "%s is off by %g" % (name, worst))
    flow.rigcal("export", "nobody", "--out", flow.folder / "none.g2o", exit_code=4)
    flow.rigcal("export", "ring", "--out", flow.folder / "ring.drawing", exit_code=4)


def many_of_one_pair(flow):
    """Older edges of a pair are merged: whoever pushed them gets the result all the same, the first time and again."""
    path = flow.folder / "many.json"
    triangle_of = lambda k: [edge("a", "b", 1.0 + 1e-6 * k), edge("b", "c", 1.0 - 1e-6 * k), edge("a", "c", 2.0 + 1e-6 * k)]
    path.write_text(json.dumps({"format": 1, "edges": [one for k in range(12) for one in triangle_of(k)]}))
    for held_before in (0, 36):
        pushed = json.loads(flow.rigcal("push-edges", path, "--robot", "many", "--json").stdout)
        check(pushed["held_before"] == held_before, "held before: %r" % pushed)
    shown = json.loads(flow.rigcal("show", "many", "--json").stdout)
    merged = [one["figures"]["merged_edges"] for one in shown["document"]["edges"] if "merged_edges" in one["figures"]]
    check(shown["revision"] == 1 and merged == [4, 4, 4] and len(shown["document"]["edges"]) == 27, "4 of 12 are merged: %r" % merged)
    check(len(json.loads(flow.rigcal("edges", "many", "--json").stdout)["edges"]) == 36, "all edges are listed")


def refers_to_edges(flow):
    """A revision refers to its edges; whole ones, merged ones too, and pages of a history come when they are asked for."""
    shown = json.loads(flow.rigcal("show", "many", "--json").stdout)["document"]
    whole = json.loads(flow.rigcal("show", "many", "--whole", "--json").stdout)["document"]
    check((shown["format"], whole["format"]) == (2, 1), "formats: %r, %r" % (shown["format"], whole["format"]))
    check([one["id"] for one in shown["edges"]] == [one["id"] for one in whole["edges"]], "the same edges")
    check(not any("information" in one for one in shown["edges"]) and all("information" in one for one in whole["edges"]), "whole ones have it")
    merged = next(one for one in shown["edges"] if "merged_edges" in one["figures"])
    told = json.loads(flow.get("/api/v1/edge?id=" + merged["id"]))
    check(told["figures"]["merged_edges"] == 4 and told["T_a_b"] == merged["T_a_b"], "the merged edge: %r" % told)
    page = json.loads(flow.rigcal("edges", "many", "--limit", 5, "--json").stdout)
    check(len(page["edges"]) == 5 and page["next"] == page["edges"][-1]["id"], "a page: %r" % page["next"])
    rest = json.loads(flow.get("/api/v1/edges?robot=many&limit=1000&before=" + page["next"]))
    check(len(rest["edges"]) == 31 and rest["next"] is None, "the rest: %d, %r" % (len(rest["edges"]), rest["next"]))
    told = flow.rigcal("history", "many").stdout
    check(told.count("\n") == 2 and told.startswith("REVISION"), "one revision: " + told)


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

        g2o_round_trip(flow)
        many_of_one_pair(flow)
        refers_to_edges(flow)
        flow.kill_and_restart()
        check(newest(flow) ["document"] == shown["document"], "the revision survives kill -9")
        check(json.loads(flow.get("/api/v1/show?robot=rig"))["digest"] == shown["digest"], "HTTP gives the same document")
        check("rig" in flow.get("/"), "the fleet page lists the robot")
        listed = [row["robot"] for row in json.loads(flow.rigcal("robots", "--json").stdout)["robots"]]
        part = json.loads(flow.rigcal("robots", "--limit", "1", "--json").stdout)
        check([row["robot"] for row in part["robots"]] == listed[:1] and "rig" in listed, "a part of the list: %r of %r" % (part, listed))
        check(part["next"] == (listed[0] if len(listed) > 1 else None), "where the next part begins: %r" % part)
        check("<svg" in flow.get("/robots/rig/revisions/%d/" % shown["revision"]), "the report has a drawing")
        flow.rigcal("due", "--max-age", "90d")
        flow.rigcal("doctor")
    print("edges: good")


if __name__ == "__main__":
    main()
