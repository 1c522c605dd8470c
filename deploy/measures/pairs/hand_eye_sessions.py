"""Recordings of robots, trackers and visual-inertial sensors as session folders."""
import re
import shutil

from ..rotations import of_vector

TRACKER = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n"
STREAM = "stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw\n"


def make_visp(source, folder, robot="franka"):
    """A camera on a robot's flange, 8 pictures: `handeye_visp_franka/data-eye-in-hand`."""
    camera = (source / "franka_camera.xml").read_text()
    px, py, u0, v0 = (float(re.search(r"<%s>(.*?)</%s>" % (tag, tag), camera).group(1)) for tag in ("px", "py", "u0", "v0"))
    (folder / "camera").mkdir(parents=True)
    (folder / "flange").mkdir()
    (folder / "session.yaml").write_text("""format: 1
robot: %s
captured_at: 2019-01-01T00:00:00Z
reference: flange
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.0236}
sensors:
  flange: {type: tracker}
  camera:
    type: camera
    intrinsics: {fx_px: %r, fy_px: %r, cx_px: %r, cy_px: %r}
""" % (robot, px, py, u0, v0))
    rows = ""
    for number in range(1, 9):
        text = (source / ("franka_pose_rPe_%d.yaml" % number)).read_text()
        pose = [float(word) for word in re.findall(r"\[(.*?)\]", text)]
        rows += "%d,%d,%s\n" % (number, number, ",".join(repr(v) for v in pose[:3] + of_vector(pose[3:])))
        shutil.copyfile(source / ("franka_image-%d.png" % number), folder / "camera" / ("%d.png" % number))
    (folder / "flange" / "poses.csv").write_text(TRACKER + rows)


def stream_of(recording):
    """Rows t, x y z, qx qy qz qw of a recording; of rows with one stamp the first."""
    rows, last = "", -1
    for line in recording.read_text().splitlines():
        fields = [word.strip() for word in line.split(",")]
        whole, _, part = fields[0].partition(".")
        stamp = int(whole) * 10**9 + int((part + "000000000")[:9])
        if stamp > last:
            rows += "%d,%s\n" % (stamp, ",".join(fields[1:8]))
            last = stamp
    return STREAM + rows


def make_streams(recordings, folder, robot="rig"):
    """`recordings`: name -> csv. One session of pose streams."""
    folder.mkdir(parents=True)
    text = "format: 1\nrobot: %s\ncaptured_at: 2017-04-09T00:00:00Z\nsensors:\n" % robot
    for name, recording in recordings.items():
        text += "  %s: {type: pose_stream}\n" % name
        (folder / name).mkdir()
        (folder / name / "poses.csv").write_text(stream_of(recording))
    (folder / "session.yaml").write_text(text)


def vicon(data):
    folder = data / "handeye_asl" / "prime_sense_color_w_vicon_1" / "prime_sense_1"
    return {"body": next(folder.glob("*vicon*.csv")), "camera": next(folder.glob("*camera*.csv"))}


def robot_arm(data):
    folder = data / "handeye_asl" / "robot_arm_w_color_camera_sim" / "robot_arm_w_color_camera_sim"
    return {"hand": folder / "robot_arm_sim_hand.csv", "camera": folder / "robot_arm_sim_camera.csv"}


def tango(data):
    folder = data / "handeye_asl" / "tango_triplet_easy" / "TANGO_exCALIBur_2"
    return {name: next(folder.glob(name.upper() + "_*.csv")) for name in ("caligula", "mars", "nero")}
