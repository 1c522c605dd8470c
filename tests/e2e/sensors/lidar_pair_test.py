"""Two lidars of a virtual robot: NDT's pose, and polished where session.yaml asks for it, marked wherever it is shown."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from lidar_rig import rig_of  # noqa: E402

REFUSED = 4  # exit code


def edges_of(flow):
    return json.loads(flow.rigcal("show", "pair", "--whole", "--json").stdout)["document"]["edges"]


def codes(edge):
    return [diagnosis["code"] for diagnosis in edge["diagnoses"]]


def check_error(flow, visit, what):
    compared = json.loads(flow.rigcal("compare", "pair", "--poses", visit / "truth.yaml", "--json").stdout)
    error = next(sensor for sensor in compared["sensors"] if sensor["id"] == "lidar_horizontal")["e"]
    off_m, off_rad = (sum(e * e for e in half) ** 0.5 for half in (error[:3], error[3:]))
    check(off_m < 0.025 and off_rad < 0.0061, "%s is off by %.4f m, %.5f rad" % (what, off_m, off_rad))


def check_plain(flow, visit):
    edge, = edges_of(flow)
    check(edge["state"] == "good" and edge["method"] == "lidar_lidar", "NDT alone: %r" % edge)
    check("polished" not in codes(edge) and edge["figures"]["polished_ratio"] == 0, "nothing is polished: %r" % edge)
    check("gicp" not in flow.rigcal("edges", "pair").stdout.lower(), "`edges` speaks of no GICP")
    check("polished" not in flow.get("/robots/pair/revisions/1/"), "nor does the report of a polish")
    check_error(flow, visit, "NDT")
    return edge


def check_polished(flow, visit, plain):
    past, edge = sorted(edges_of(flow), key=lambda edge: edge["state"] == "good")
    check(codes(past) == ["superseded"] and past["session"] == plain["session"], "the first one is past: %r" % past)
    check(edge["state"] == "good" and edge["method"] == "lidar_lidar" and "polished" in codes(edge), "polished: %r" % edge)
    check(edge["figures"]["polished_ratio"] == 1, "figures say so: %r" % edge["figures"])
    moved_m = sum((p - q) ** 2 for p, q in zip(edge["T_a_b"]["p_m"], plain["T_a_b"]["p_m"])) ** 0.5
    check(abs(moved_m - edge["figures"]["polish_moved_m"]) < 2e-5, "moved by what is said: %.6f m, %r" % (moved_m, edge["figures"]))
    listed = flow.rigcal("edges", "pair").stdout
    check("lidar_lidar+gicp" in listed and "polished from there by generalised ICP" in listed, "`edges` says so: " + listed)
    check("lidar_lidar+gicp" in flow.rigcal("show", "pair").stdout, "`show` says so")
    page = flow.get("/robots/pair/revisions/2/")
    check("lidar-lidar, polished by GICP" in page and "polished from there by generalised ICP" in page, "the report says so")
    check_error(flow, visit, "the polished pose")


def main():
    with Flow() as flow:
        visit = flow.folder / "visit"
        flow.rigcal("simulate", rig_of(flow), "--out", visit, "--seed", 1, "--captures", 8)
        header = visit / "session.yaml"
        text = header.read_text()
        session = json.loads(flow.rigcal("push", visit, "--json").stdout)["id"]
        plain = check_plain(flow, visit)
        check(plain["session"] == session, "the session is the one pushed")
        header.write_text(text + "lidar_polish: none\n")
        again = json.loads(flow.rigcal("push", visit, "--json").stdout)
        check(again["id"] == session and again["held_before"] == again["total"], "none is what it is without: %r" % again)
        header.write_text(text + "lidar_polish: point_to_plane\n")
        refused = flow.rigcal("push", visit, exit_code=REFUSED).stderr
        check("lidar_polish: polish \"point_to_plane\" is not known" in refused and "Use gicp" in refused, "refused: " + refused)
        header.write_text(text + "lidar_polish: gicp\n")
        check(json.loads(flow.rigcal("push", visit, "--json").stdout)["id"] != session, "asked for, it is another session")
        check_polished(flow, visit, plain)
    print("lidar pair: good")


main()
