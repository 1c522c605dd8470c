"""Four webcams round a ChArUco board, frames out of videos, pushed to a real rigcald and compared with the author's rig."""
import itertools
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tomllib

from ..measure import at_most, equal, info, skip
from ..rotations import matrix_of, product, transposed
from ..server import ANSWERED, Server


def relative(author, a, b):
    """R and p of T_a_b. The author's rotation and translation of a camera map world points into it."""
    (R_a, t_a), (R_b, t_b) = author[a], author[b]
    R = product(R_a, transposed(R_b))
    return R, [t_a[i] - sum(R[i][k] * t_b[k] for k in range(3)) for i in range(3)]


def difference(edge, author):
    R, p = relative(author, edge["frame_a"], edge["frame_b"])
    ours = matrix_of(edge["T_a_b"]["q_xyzw"])
    trace = sum(R[i][k] * ours[i][k] for i in range(3) for k in range(3))
    angle_deg = math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1) / 2))))
    return angle_deg, math.dist(p, edge["T_a_b"]["p_m"]) / math.hypot(*p) * 100


def run(context):
    source = context.data / "multicam_caliscope" / "4_cam_recording"
    if not source.is_dir() or not shutil.which("ffmpeg"):
        yield skip("multicam_caliscope", "no data or no ffmpeg")
        return
    array = tomllib.loads((source / "camera_array.toml").read_text())["cameras"]
    author = {"cam_" + name: (camera["rotation"], camera["translation"]) for name, camera in array.items()}
    with context.folder() as temporary:
        session = pathlib.Path(temporary) / "session"
        subprocess.run([sys.executable, str(context.root / "tests" / "data" / "extract_caliscope.py"), str(source), str(session)],
                       check=True, stdout=subprocess.DEVNULL)
        with Server(context, pathlib.Path(temporary) / "store") as server:
            if server.rigcal("push", session, "--new-robot").returncode not in ANSWERED:
                raise RuntimeError("push failed")
            document = json.loads(server.rigcal("show", "caliscope-rig", "--whole", "--json").stdout)["document"]
    edges = [edge for edge in document["edges"] if edge["state"] == "good"]
    yield equal("caliscope_pairs", "%d/%d" % (len(edges), len(list(itertools.combinations(author, 2)))), "6/6")
    differences = [difference(edge, author) for edge in edges]
    yield at_most("caliscope_worst_rotation", max(angle for angle, _ in differences), 1.0, "deg")
    yield at_most("caliscope_worst_translation", max(percent for _, percent in differences), 2.0, "%")
    yield info("caliscope_worst_rms", max(edge["figures"]["rms_px"] for edge in edges), "px")
