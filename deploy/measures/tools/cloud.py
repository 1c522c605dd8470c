"""Colouring a cloud: speed, honesty at edges, same bytes; and two real recordings through the service."""
import pathlib
import re
import time

from ..measure import at_least, at_most, equal, info, skip
from ..pairs import acfr_session, road_session
from ..server import ANSWERED, Server


def publish(context, folder, robot, session, edges=None):
    """Pushes to a real server; the newest report folder and the seconds from push to the files."""
    with Server(context, folder / "store") as server:
        start = time.monotonic()
        if edges and server.rigcal("push-edges", edges, "--robot", robot).returncode not in ANSWERED:
            raise RuntimeError("push-edges failed")
        if server.rigcal("push", session).returncode not in ANSWERED:
            raise RuntimeError("push failed")
        reports = folder / "store" / "reports" / robot
        revisions = sorted((int(path.name) for path in reports.iterdir() if path.name.isdigit()))
        return reports / str(revisions[-1]), time.monotonic() - start


def share_covered(report):
    """Percent of the points that a camera sees, as the page says it."""
    found = re.search(r"points, (\d+) % seen by", (report / "index.html").read_text())
    return int(found.group(1)) if found else 0


def complete(report):
    wanted = ["cloud/lidar/" + name for name in ("front.png", "top.png", "oblique.png", "cloud.ply", "points.bin")]
    wanted += ["overlay/camera.jpg", "overlay/camera_picture.jpg"]
    return sum((report / name).is_file() for name in wanted)


def run_real(context):
    acfr, road = context.data / "lidarcam_acfr_vlp16", context.data / "lidarcam_opencalib_road"
    for name, source in (("acfr", acfr), ("road", road)):
        if not source.is_dir():
            yield skip("real_" + name, "no data")
            continue
        with context.folder() as temporary:
            folder = pathlib.Path(temporary)
            edges = None
            if name == "acfr":
                acfr_session.make(source, folder / "session")
            else:
                edges = road_session.make(source, folder / "session")
            report, seconds = publish(context, folder, name, folder / "session", edges)
            yield equal("files_" + name, complete(report), 7)
            yield at_least("covered_" + name, share_covered(report), 10, "%")
            yield info("push_to_published_" + name, seconds, "s")


def run(context):
    result = context.run_json("cloud_measure")
    yield at_most("colour_1M_points_7_cameras_5MP_two_threads", result["colour_ms"], 150.0, "ms")  # median of 9
    yield info("fastest_of_it", result["best_ms"], "ms")
    yield info("processor_time_of_it", result["processor_ms"], "ms")
    yield equal("same_bytes_1_and_2_threads", result["same_bytes"], True)
    yield at_most("wall_points_painted_as_plate", result["painted_as_plate"], 200)
    yield at_most("rings_wall_points_painted_through_a_plate", result["rings_hidden_painted"], 20)
    yield at_most("rings_points_in_sight_not_painted", 100 * result["rings_missed"] / result["rings_in_sight"], 0.2, "%")
    yield at_most("plate_points_not_painted", result["plate_missed"], result["plate_points"] // 1000)
    yield info("covered_of_the_room", 100 * result["covered_ratio"], "%")
    yield from run_real(context)
