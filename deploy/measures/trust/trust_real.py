"""Real recordings whose lenses are not quite what their models say."""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

from ..measure import Measure, at_most, equal, info, skip
from ..rotations import matrix_of, product, transposed
from ..server import ANSWERED, Server
from ..tools.formats import relative

# What a pair may fail for where the recording is right: too little of it, or a lens that its model does not describe.
RIGHT_CAUSES = ("too_few_captures", "no_common_view", "ill_conditioned", "distortion_not_observable", "no_tilt")
AUTHOR_T_MM = (-75.00, 1.245, -0.549)  # left points into the right camera


def splits(context):
    folder = context.data / "stereo_opencv"
    if not folder.is_dir():
        yield skip("stereo_opencv_splits", "no data in " + folder.name)
        return
    for name, split in context.run_json("trust_measure", "splits", folder).items():
        sigmas = split["sigmas"] if split["good"] else math.inf
        yield at_most("stereo_opencv_%s_sigmas" % name, sigmas, 3.0)
        if split["good"]:
            yield info("stereo_opencv_%s_apart" % name, "%.3gmm_%.3gdeg" % (split["apart_mm"], split["apart_deg"]))


def judged(context, session, robot):
    """The rows of the edges and the document of one push."""
    with context.folder() as data, Server(context, pathlib.Path(data) / "data") as server:
        pushed = server.rigcal("push", session, "--json", "--new-robot", timeout=600)
        if pushed.returncode not in ANSWERED:
            raise RuntimeError("rigcal push %s: exit %d: %s" % (session, pushed.returncode, pushed.stderr.strip()[-300:]))
        edges = json.loads(server.rigcal("edges", robot, "--json").stdout)["edges"]
        return edges, json.loads(server.rigcal("show", robot, "--json").stdout)["document"]


def text_of(edge):
    return " ".join(diagnosis["what"] + " " + diagnosis["cure"] for diagnosis in edge["diagnoses"])


def turned(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def error_of(edge, R_true, p_true):
    """Log(T^-1 T_true): metres and radians, along and about the axes of b."""
    R = matrix_of(edge["T_a_b"]["q_xyzw"])
    p = turned(transposed(R), [p_true[i] - edge["T_a_b"]["p_m"][i] for i in range(3)])
    D = product(transposed(R), R_true)
    sine = [(D[2][1] - D[1][2]) / 2, (D[0][2] - D[2][0]) / 2, (D[1][0] - D[0][1]) / 2]
    length = math.sqrt(sum(s * s for s in sine))
    angle = math.atan2(length, (D[0][0] + D[1][1] + D[2][2] - 1) / 2)
    return p + [s * angle / length if length > 0 else 0.0 for s in sine]


def in_sigmas(error, edge):
    return max(abs(e) / s for e, s in zip(error, edge["sigma_m"] + edge["sigma_rad"]))


def wrong_causes(edges):
    for edge in edges:
        code = edge["diagnoses"][0]["code"] if edge["diagnoses"] else "no_reason"
        if edge["state"] != "good" and code not in RIGHT_CAUSES and not re.search(r"\blens\b", text_of(edge)):
            yield "%s-%s:%s" % (edge["frame_a"], edge["frame_b"], code)


def caliscope_cases(context, folder, source):
    """(title, session): the author's intrinsics, then estimated from 5, 10 and 20 frames."""
    for frames, is_given in ((20, True), (5, False), (10, False), (20, False)) if context.full else ((20, True), (10, False)):
        title = "caliscope_%s_%d_frames" % ("given" if is_given else "estimated", frames)
        session = folder / title
        subprocess.run([sys.executable, context.root / "tests" / "data" / "extract_caliscope.py", source, session, "--frames", str(frames)],
                       check=True, stdout=subprocess.DEVNULL)
        if not is_given:
            yaml = session / "session.yaml"
            yaml.write_text(re.sub(r"    intrinsics:\n      model: (\w+)\n(?:      .*\n)+", r"    model: \1\n", yaml.read_text()))
        yield title, session


def caliscope(context):
    source = context.data / "multicam_caliscope" / "4_cam_recording"
    if not source.is_dir() or shutil.which("ffmpeg") is None:
        yield skip("caliscope", "no recording, or no ffmpeg to read it")
        return
    with open(source / "camera_array.toml", "rb") as file:
        author = {"cam_" + key: (camera["rotation"], camera["translation"]) for key, camera in tomllib.load(file)["cameras"].items()}
    with context.folder() as name:
        for title, session in caliscope_cases(context, pathlib.Path(name), source):
            edges, document = judged(context, session, "caliscope-rig")
            verdict = document["verdict"]
            said = verdict["why"] + " " + verdict["what_to_do"]
            yield equal(title + "_moved_said", bool(re.search(r"\bmoved\b|two poses", said)), False)
            good = [edge for edge in edges if edge["state"] == "good" and edge["rank"] == 6]
            worst = max((in_sigmas(error_of(edge, *relative(author, edge["frame_a"], edge["frame_b"])), edge) for edge in good), default=0.0)
            yield at_most(title + "_worst_good_edge_sigmas", worst, 3.0)
            yield info(title + "_good_edges", "%d_of_%d" % (len(good), len(edges)))
            yield equal(title + "_failed_for_another_cause", ",".join(sorted(wrong_causes(edges))) or "none", "none")


def baseline_mm(edge):
    """Of left points into the right camera; the pair may be either way round."""
    R, p = matrix_of(edge["T_a_b"]["q_xyzw"]), edge["T_a_b"]["p_m"]
    return [1e3 * v for v in (p if edge["frame_a"] == "right" else [-x for x in turned(transposed(R), p)])]


def charuco_sigmas(edge):
    return max(abs(t - a) / (1e3 * s) for t, a, s in zip(baseline_mm(edge), AUTHOR_T_MM, edge["sigma_m"]))


def told_sigmas(document):
    """Of the pose that `lookup` gives, right in left: its inverse's translation t against the author's, by dt = [t]x r - p."""
    if document.get("fused", {}).get("sensors") != ["right"]:
        return math.inf
    [right] = [sensor for sensor in document["sensors"] if sensor["id"] == "right"]
    t_mm = baseline_mm({"frame_a": "left", "T_a_b": right["T_ref_sensor"]})
    x, y, z = (1e-3 * v for v in t_mm)
    lower = document["fused"]["covariance"]
    C = [[lower[max(i, k)][min(i, k)] for k in range(6)] for i in range(6)]
    J = [[-1, 0, 0, 0, -z, y], [0, -1, 0, z, 0, -x], [0, 0, -1, -y, x, 0]]
    variances = [sum(row[i] * C[i][k] * row[k] for i in range(6) for k in range(6)) for row in J]
    return max(abs(t - a) / (1e3 * math.sqrt(v)) for t, a, v in zip(t_mm, AUTHOR_T_MM, variances))


def charuco(context):
    source = context.data / "stereo_charuco_wide"
    if not source.is_dir():
        yield skip("charuco_wide", "no data in " + source.name)
        return
    for model in ("pinhole_rational", "pinhole_radtan", "fisheye_kb4"):
        with context.folder() as name:
            session = pathlib.Path(name) / "session"
            shutil.copytree(source, session, ignore=shutil.ignore_patterns("PROVENANCE*"))
            text = (session / "session.yaml").read_text().replace("DICT_4X4_250}", "DICT_4X4_250, legacy_layout: true}")
            (session / "session.yaml").write_text(text.replace("pinhole_rational", model))
            [edge], document = judged(context, session, "charuco-wide")
        is_good = edge["state"] == "good"
        if model == "pinhole_radtan":
            yield Measure("charuco_wide_radtan", "good" if is_good else edge["diagnoses"][0]["code"], "refused:_try_pinhole_rational",
                          "ok" if not is_good and "pinhole_rational" in text_of(edge) else "SHORT")
            continue
        if model == "pinhole_rational":
            yield at_most("charuco_wide_rational_rms", edge["figures"].get("rms_px", math.inf) if is_good else math.inf, 0.36, "px")
        yield at_most("charuco_wide_%s_sigmas" % model, charuco_sigmas(edge) if is_good else math.inf, 3.0)
        yield at_most("charuco_wide_%s_told_sigmas" % model, told_sigmas(document), 3.0)


def run(context):
    for part in (splits, caliscope, charuco):
        yield from part(context)
