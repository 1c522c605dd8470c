"""The virtual MARS Mapper without rendering, hundreds of visits: whether what is claimed of its sensors holds."""
import json
import pathlib
import re

from ..chance import by_chance
from ..measure import at_least, at_most, equal, info, processors, within
from ..server import ANSWERED, Server

BEYOND_4_SIGMA = 0.077  # % of errors expected, where sigmas are those of 20 captures: Student's t of 19 degrees of freedom


def coverage(context):
    seeds = 200 if context.full else 6
    result = context.run_json("rig_coverage", "coverage", seeds, timeout=20000)["coverage"]
    yield equal("coverage_failed_edges", result["failed_edges"], 0)
    for name, sensor in result["sensors"].items():
        covered = 100 * sensor["covered_ratio"]
        # Of few visits the part that is covered says little.
        yield within("covered_" + name, covered, 95, 3, "%") if context.full else info("covered_" + name, covered, "%")
        yield info("mean_t2_" + name, sensor["mean_t2"])
    sensors = result["sensors"].values()
    count = sum(sensor["count"] for sensor in sensors)
    yield equal("coverage_poses", count, 11 * seeds)
    yield at_least("covered_of_all", 100 * sum(s["covered_ratio"] * s["count"] for s in sensors) / count, 92 if context.full else 85, "%")
    for name, method in result["methods"].items():
        yield info("edges_mean_t2_" + name, method["mean_t2"])
        yield info("edges_covered_" + name, 100 * method["covered_ratio"], "%")


def motions(context):
    seeds = 5 if context.full else 1
    yield from by_chance(context, "motion_edge", 20, 6, 59 * seeds)
    result = context.run_json("rig_coverage", "motions", seeds, timeout=20000)
    for name in ("planar", "on_the_spot"):
        for case in result[name]:
            title = "%s_tilt_%g" % (name, case["tilt_deg"])
            yield at_most(title + "_edge_sigmas", case["worst_edge_sigmas"], 4.0)
            yield at_most(title + "_edge_axis_sigmas", case["worst_edge_axis_sigmas"], 4.0)
            yield at_most(title + "_pose_sigmas", case["worst_pose_sigmas"], 4.0)
            if case["edges_open"] > 0:
                yield at_most(title + "_axis", case["axis_deg"], 2.0, "deg")
            yield info(title + "_mean_squares", "%.2f_%.2f" % (case["edge_mean_square"], case["pose_mean_square"]))
            yield info(title + "_edges_open_failed", "%d_%d" % (case["edges_open"], case["edges_failed"]))
        beyond, claims = (sum(case[key] for case in result[name]) for key in ("edge_claims_beyond_4", "edge_claims"))
        yield at_most(name + "_edge_claims_beyond_4_sigma", 100 * beyond / claims, BEYOND_4_SIGMA, "%")
        yield info(name + "_edge_claims", claims)
        yield equal(name + "_tracker_height_claimed", sum(case["body_known"] for case in result[name] if case["tilt_deg"] == 0), 0)
        yield equal(name + "_tracker_unknown_unsaid", sum(case["body_unsaid"] for case in result[name]), 0)


def given(context):
    result = context.run_json("rig_coverage", "given", 10 if context.full else 1, timeout=20000)["given"]
    for name, case in result.items():
        yield at_most(name + "_sigmas", case["worst_sigmas"], 4.0)
        yield at_most(name + "_sigma_over_error", case["sigma_over_error"], 5.0)
        yield at_most(name + "_sigma_over_error_turned", case["sigma_over_error_turned"], 5.0)
        yield equal(name + "_failed_edges", case["failed_edges"], 0)


def lidar_beams(context):
    result = context.run_json("rig_coverage", "lidar_beams", 12 if context.full else 3, timeout=20000)["lidar_beams"]
    yield equal("lidar_pair_beams_5_mm_off_failed_edges", result["failed"], 0)
    yield at_most("lidar_pair_beams_5_mm_off_sigmas", result["worst_sigmas"], 4.0)
    yield at_most("lidar_pair_beams_5_mm_off_mean_square", result["mean_square"], 2.0)
    yield info("lidar_pair_beams_5_mm_off_mean_square_if_not_given", result["mean_square_without_beams"])


def turned(context):
    result = context.run_json("rig_coverage", "turned", 5 if context.full else 1, timeout=20000)["turned"]
    for name, case in result.items():
        yield at_most("turned_%s_moved" % name, case["moved_mm"], 0.001, "mm")
        yield at_most("turned_%s_turned" % name, case["moved_deg"], 0.0001, "deg")
        yield at_most("turned_%s_sigmas" % name, case["worst_sigmas"], 4.0)
        yield equal("turned_%s_failed" % name, case["failed"], 0)


def revision_of(context, session, data, count, *extra):
    """The revision of one push, by a server that has so many processors."""
    with processors(count), Server(context, data) as server:
        done = server.rigcal("push", session, "--json", "--new-robot", *extra, timeout=1800)
        if done.returncode not in ANSWERED:
            raise RuntimeError("rigcal push: exit %d: %s" % (done.returncode, done.stderr.strip()[-300:]))
        return json.loads(server.rigcal("show", "mars-mapper", "--json").stdout)


def without_clock(page):
    """A page says when it was solved: that is the clock's, and is taken out. Times of captures stay."""
    for solved in set(re.findall(rb"[Ss]olved (\d{4}-\d\d-\d\d \d\d:\d\d:\d\d UTC)", page)):
        page = page.replace(solved, b"")
    return page


def written_by(data):
    """Every file that a server published or keeps by its contents: name and bytes."""
    files = {}
    for part in ("reports", "blobs"):
        for path in sorted((data / part).rglob("*")):
            if path.is_file():
                content = path.read_bytes()
                files[str(path.relative_to(data))] = without_clock(content) if path.suffix == ".html" else content
    return files


def same_files(folders):
    written = [written_by(folder) for folder in folders]
    names = sorted(set().union(*written))
    differ = [name for name in names if len({one.get(name) for one in written}) > 1]
    yield equal("written_files_that_differ", ",".join(differ[:5]) or "none", "none")
    published = [name for name in names if name.startswith("reports/")]
    yield at_least("published_files_compared", len(published), 100)
    kinds = {pathlib.PurePath(name).suffix for name in published}
    yield equal("published_kinds_missing", ",".join(sorted({".html", ".js", ".json", ".csv", ".png", ".ply", ".jpg", ".bin"} - kinds)) or "none", "none")


def same_bytes(context):
    result = context.run_json("rig_coverage", "same_bytes", 3 if context.full else 1, timeout=2000)["same_bytes"]
    yield equal("edges_differ_from_one_and_two_threads", result["one_and_two_threads_differ"], 0)
    yield equal("edges_of_one_and_two_threads", result["good_edges"], 59 * result["visits"])
    with context.folder() as name:
        folder = pathlib.Path(name)
        context.run_json("rigcal", "simulate", "mars-mapper", "--out", folder / "visit", "--captures", 8, "--scale", 0.3, "--json")
        shown = [revision_of(context, folder / "visit", folder / "one", 1),
                 revision_of(context, folder / "visit", folder / "two", 2, "--shuffle", 1),
                 revision_of(context, folder / "visit", folder / "three", 2, "--shuffle", 2)]
        yield from same_files([folder / "one", folder / "two", folder / "three"])
    yield equal("revisions_that_differ", len({one["digest"] for one in shown}) - 1, 0)
    yield at_least("revision_good_edges", sum(edge["state"] == "good" for edge in shown[0]["document"]["edges"]), 50)


def jackknives(context):
    result = context.run_json("rig_coverage", "time", timeout=2000)["time"]
    yield equal("jackknives", result["edges"], 59)
    yield at_most("all_estimates_and_jackknives", result["wall_s"], 10.0, "s")
    yield info("all_estimates_and_jackknives_processor", result["processor_s"], "s")


def run(context):
    for part in (jackknives, same_bytes, coverage, motions, given, lidar_beams, turned):
        yield from part(context)
