"""Processor time of one thread from a grey 5 MP picture to the corners of a board, and whether they are right."""
from ..measure import at_least, at_most, equal, info


def run(context):
    result = context.run_json("board_speed_measure", context.data, 3000 if context.full else 300, timeout=3600)
    yield at_most("board_found_5mp_ms", result["found_median_ms"], 40.0, "ms")
    yield info("board_found_5mp_max_ms", result["found_max_ms"], "ms")
    yield at_most("board_none_5mp_ms", result["none_median_ms"], 150.0, "ms")
    yield at_most("board_none_5mp_max_ms", result["none_max_ms"], 150, "ms")
    yield at_most("charuco_none_5mp_max_ms", result["charuco_none_max_ms"], 150.0, "ms")
    yield at_most("tags_none_5mp_median_ms", result["tags_none_median_ms"], 150.0, "ms")
    yield at_most("tags_none_5mp_max_ms", result["tags_none_max_ms"], 300.0, "ms")
    yield info("decode_png_5mp_ms", result["decode_png_ms"], "ms")
    yield info("decode_jpeg_5mp_ms", result["decode_jpeg_ms"], "ms")
    if result["reference_corners"] > 0:
        yield at_most("corners_rms_px", result["reference_rms_px"], 0.05, "px")
    # One refinement behind both searches would hide its own errors. The truth is that of drawn boards with noise of 1 % of
    # their contrast, then of 10 %; without smoothing they are 0.030 and 0.54 px.
    yield at_most("corners_rms_to_other_refinement", result["other_reference_rms_px"], 0.05, "px")
    yield equal("corners_compared_with_other_refinement", result["other_reference_corners"], result["truth_corners"])
    yield at_most("corners_rms_to_truth", result["truth_rms_px"], 0.025, "px")
    yield at_most("corners_rms_to_truth_where_noise_is_strong", result["hard_truth_rms_px"], 0.4, "px")
    yield info("corners_rms_to_other_refinement_real", result["real_reference_rms_px"], "px")
    yield equal("boards_found_drawn", "%d/%d" % (result["drawn_found"], result["drawn"]), "%d/%d" % (result["drawn"], result["drawn"]))
    yield equal("boards_found_real", "%d/%d" % (result["real_found"], result["real"]), "%d/%d" % (result["real"], result["real"]))
    yield equal("wrong_boards", result["wrong"], 0)
    yield at_least("boards_found_small_ratio", result["small_found"] / max(1, result["small"]), 0.9)
