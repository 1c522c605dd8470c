"""A virtual robot with a lidar and a tracked body before five boards: pushed as a folder, calibrated by the service,
against its truth; and the same robot on a level floor, of which the height is told as not measured and the rest as a result."""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from measures.pairs import tracker_lidar_sessions  # noqa: E402


def sigmas_of(edge, error):
    return [abs(e) / s for e, s in zip(error["e"], edge["sigma_m"] + edge["sigma_rad"])]


def true_position_of_body(visit):
    return [float(number) for number in re.search(r"body:\n.*\n +T_ref_sensor: {p_m: \[([^]]*)\]", (visit / "truth.yaml").read_text()).group(1).split(",")]


def check_what_was_measured(flow, level):
    """On a level floor, in the frame of the lidar: all but the height, as good as it says."""
    shown = json.loads(flow.rigcal("show", level.name, "--json", exit_code=6).stdout)["document"]
    body = next(sensor for sensor in shown["sensors"] if sensor["id"] == "body")
    check(body["known"] is False and body["T_ref_sensor"] is None, "no whole pose: %r" % body)
    axes = {axis["name"]: axis for axis in body["measured_part"]["axes"]}
    check(axes["height"]["sigma_m"] is None and axes["height"]["position_m"] is None, "the height has no number: %r" % axes["height"])
    truth = true_position_of_body(level)
    for name in ("forward", "sideways"):
        off_m = axes[name]["position_m"] - sum(u * v for u, v in zip(axes[name]["direction"], truth))
        check(abs(off_m) < 4 * axes[name]["sigma_m"] < 0.01, "%s is off by %.2f mm: %r" % (name, 1e3 * off_m, axes[name]))
    check(all(0 < axes[name]["sigma_rad"] < 0.01 for name in ("roll", "pitch", "yaw")), "turns: %r" % axes)
    text = flow.rigcal("show", level.name, exit_code=6).stdout
    check("The height of body was not measured; the rest is good to" in text and "height not measured" in text, "in words: " + text)
    told = json.loads(flow.rigcal("lookup", level.name, "body", "lidar_vertical", "--json", exit_code=6).stdout)
    check(told["known"] is False and told["T_a_b"] is None and len(told["unobservable_basis"]) == 1, "lookup: %r" % told)
    check("height of lidar_vertical in body" in flow.rigcal("lookup", level.name, "body", "lidar_vertical", exit_code=6).stdout, "and in words")
    flow.rigcal("export", level.name, "--out", flow.folder / "level.g2o")
    check("not measured" in (flow.folder / "level.g2o").read_text(), "the file says so")


def main():
    with Flow() as flow:
        for lidar in tracker_lidar_sessions.LIDARS:
            visit, bound = tracker_lidar_sessions.simulate(flow.context, flow.folder, lidar, 1, "--captures", "24")
            flow.rigcal("push", visit)
            edge = tracker_lidar_sessions.edge_of(flow.server, visit)
            check(edge["state"] == "good" and edge["rank"] == 6, "%s: %r" % (lidar, edge["diagnoses"]))
            check({edge["frame_a"], edge["frame_b"]} == {lidar, "body"}, "frames of %s" % lidar)
            check(all(0 < capture["rms"] < 0.01 for capture in edge["captures"]), "boards within a centimetre: %r" % edge["captures"])
            error = tracker_lidar_sessions.error_of(flow.server, visit)
            worst = max(sigmas_of(edge, error))
            check(worst < 4, "%s is %.2f of its sigmas off: %r" % (lidar, worst, error))
            sigma_m = sum(s * s for s in edge["sigma_m"]) ** 0.5
            bound_m = sum(b * b for b in bound[:3]) ** 0.5
            check(sigma_m < 2 * bound_m, "%s: sigma %.4f m, the bound is %.4f m" % (lidar, sigma_m, bound_m))
            print("%s: off by %.2f mm (sigma %.2f, bound %.2f), %.2f of its sigmas at worst" % (
                lidar, 1e3 * sum(e * e for e in error["e"][:3]) ** 0.5, 1e3 * sigma_m, 1e3 * bound_m, worst))

        level, _ = tracker_lidar_sessions.simulate(flow.context, flow.folder, "lidar_vertical", 2, "--captures", "24", "--motion",
                                                   "planar", "--tilt-deg", "0")
        flow.rigcal("push", level)
        edge = tracker_lidar_sessions.edge_of(flow.server, level)
        check(edge["state"] == "good" and edge["rank"] == 5, "on a level floor: %r" % edge["diagnoses"])
        upright = (0.0523, 0.0349, 0.9980)  # in the body's frame, which the rig tilts by 3 and 2 degrees
        along = abs(sum(u * v for u, v in zip(upright, edge["unobservable_basis"][0][:3])))
        check(along > 0.9994, "the open direction is within 2 deg of upright: %r" % edge["unobservable_basis"])
        check("planar_motion" in [diagnosis["code"] for diagnosis in edge["diagnoses"]], "words: %r" % edge["diagnoses"])
        check_what_was_measured(flow, level)
        page = flow.get("/robots/%s/revisions/1/" % level.name)
        check("<div>height not measured</div>" in page, "the page's table of sensors says so")
        check("tracker-lidar" in page and "turned about one axis only" in page, "the report says so")
    print("tracker-lidar: good")


main()
