"""A virtual robot with a lidar and a tracked body before five boards: pushed as a folder, calibrated by the service,
against its truth; and the same robot on a level floor."""
from flow import Flow, check
from measures import tracker_lidar_sessions


def sigmas_of(edge, error):
    return [abs(e) / s for e, s in zip(error["e"], edge["sigma_m"] + edge["sigma_rad"])]


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
        page = flow.get("/robots/%s/revisions/1/" % level.name)
        check("tracker-lidar" in page and "turned about one axis only" in page, "the report says so")
    print("tracker-lidar: good")


main()
