"""A scene of `lidarcam_opencalib_road` as a session folder, and its pose as a file of edges: a 64-beam lidar and a 1920 x 1200 camera."""
import json
import math
import shutil


def quaternion(r):
    """x y z w of a rotation by less than 180 degrees."""
    w = math.sqrt(1 + r[0][0] + r[1][1] + r[2][2]) / 2
    q = [(r[2][1] - r[1][2]) / (4 * w), (r[0][2] - r[2][0]) / (4 * w), (r[1][0] - r[0][1]) / (4 * w), w]
    norm = math.sqrt(sum(x * x for x in q))
    return [x / norm for x in q]


def parameters(path):
    return next(iter(json.loads(path.read_text()).values()))["param"]


def make(source, folder, robot="road"):
    """Writes the session into `folder`; the path of the edges beside it."""
    data = source / "auto_calib" / "data"
    camera = parameters(data / "center_camera-intrinsic.json")
    k, d = camera["cam_K"]["data"], camera["cam_dist"]["data"][0]
    pose = parameters(data / "top_center_lidar-to-center_camera-extrinsic.json")["sensor_calib"]["data"]
    folder.mkdir(parents=True)
    (folder / "session.yaml").write_text("""format: 1
robot: %s
captured_at: 2021-01-01T00:00:00Z
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.1, plate_size_m: [1.2, 0.9]}
sensors:
  camera:
    type: camera
    intrinsics: {model: pinhole_radtan, fx_px: %r, fy_px: %r, cx_px: %r, cy_px: %r, distortion: %r}
  lidar:
    type: lidar
""" % (robot, k[0][0], k[1][1], k[0][2], k[1][2], d))
    for sensor, name, target in (("camera", "calib.png", "01.png"), ("lidar", "calib.pcd", "01.pcd")):
        (folder / sensor).mkdir()
        shutil.copyfile(data / name, folder / sensor / target)
    covariance = [[1e-6 if row == column else 0 for column in range(6)] for row in range(6)]
    edge = {"frame_a": "camera", "frame_b": "lidar", "T_a_b": {"p_m": [row[3] for row in pose[:3]], "q_xyzw": quaternion(pose)},
            "covariance": covariance, "method": "given"}
    edges = folder.parent / "edges.json"
    edges.write_text(json.dumps({"format": 1, "edges": [edge]}))
    return edges
