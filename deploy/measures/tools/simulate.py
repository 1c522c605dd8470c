"""The virtual robot: how fast it draws, whether threads show, whether the product takes what it writes."""
import hashlib
import pathlib

from ..measure import at_least, at_most, equal, info


def digest_of(folder):
    digest = hashlib.sha256()
    for path in sorted(pathlib.Path(folder).rglob("*")):
        if path.is_file():
            digest.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def simulated(context, folder, *arguments):
    return context.run_json("rigcal", "simulate", "mars-mapper", "--out", folder, "--json", *arguments)


def run(context):
    with context.folder() as folder:
        place = pathlib.Path(folder)
        full = simulated(context, place / "full", "--captures", "4", "--threads", "2")
        yield at_least("speed_per_thread", full["mpx_per_s_per_thread"], 30.0, "Mpx/s")
        yield info("bytes_per_capture", full["bytes"] // 4)
        reduced = simulated(context, place / "two", "--captures", "16", "--scale", "0.4", "--threads", "2")
        yield equal("pictures_and_clouds", "%d+%d" % (reduced["pictures"], reduced["clouds"]), "144+32")
        yield info("reduced_wall", reduced["seconds"], "s")
        simulated(context, place / "one", "--captures", "16", "--scale", "0.4", "--threads", "1")
        yield equal("same_bytes_1_and_2_threads", digest_of(place / "one") == digest_of(place / "two"), True)
        bound = context.run_json("rigcal", "simulate", "mars-mapper", "--json")["sensors"]
        cameras = [norm_of(sensor["bound_sigma"]) for sensor in bound.values() if sensor["type"] == "camera"]
        lidars = [norm_of(sensor["bound_sigma"]) for sensor in bound.values() if sensor["type"] == "lidar"]
        # Two thirds of what estimates are allowed, so that estimates can keep to it at all.
        yield at_most("bound_cameras_mm", max(m for m, _ in cameras), 0.4)
        yield at_most("bound_cameras_deg", max(deg for _, deg in cameras), 0.008)
        yield at_most("bound_lidars_mm", max(m for m, _ in lidars), 0.8)
        yield at_most("bound_lidars_deg", max(deg for _, deg in lidars), 0.033)


def norm_of(sigma):
    """(mm, deg): the length of the error, one sigma."""
    return (sum(s * s for s in sigma[:3]) ** 0.5 * 1e3, sum(s * s for s in sigma[3:]) ** 0.5 * 57.29577951308232)
