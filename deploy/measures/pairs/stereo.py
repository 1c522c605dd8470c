"""Real picture pairs: boards found, reprojection error, baseline, halves against their own sigma."""
import math

from ..measure import at_most, equal, info, skip, within


def run(context):
    folder = context.data / "stereo_opencv"
    if not folder.is_dir():
        yield skip("stereo_opencv", "no data in " + str(folder.name))
        return
    result = context.run_json("stereo_measure", folder)
    yield equal("boards_found", "%d/%d" % (result["boards_found"], result["boards_total"]), "26/26")
    yield at_most("rms", result["rms_px"], 0.23, "px")
    yield within("baseline", result["t_norm_mm"], 83.18, 0.3, "mm")
    ratio = result["odd_even_max_sigma_ratio"]
    yield at_most("odd_even_sigma_ratio", ratio if ratio >= 0 else math.inf, 3.0)  # below zero: a half gave no edge
    yield info("detect", result["detect_ms"], "ms")
    yield info("estimate_and_jackknife", result["estimate_ms"] + result["jackknife_ms"], "ms")
