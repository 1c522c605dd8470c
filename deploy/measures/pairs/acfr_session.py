"""The recording `lidarcam_acfr_vlp16` as a session folder: a fisheye camera, a VLP-16, a 5 x 7 board on a 610 x 850 mm plate."""
import re
import shutil


def numbers(text, key):
    return [float(word) for word in re.search(key + r":\s*\[(.*?)\]", text).group(1).split(",")]


def make(source, folder, robot="acfr", nominal=None):
    """Writes the session into `folder`. `nominal`: T_ref_nominal of the lidar as YAML text."""
    info = (source / "cfg" / "camera_info.yaml").read_text()
    k, d = numbers(info, "K"), numbers(info, "D")
    folder.mkdir(parents=True)
    (folder / "session.yaml").write_text("""format: 1
robot: %s
captured_at: 2021-01-01T00:00:00Z
targets:
  board: {type: checkerboard, inner_corners: [5, 7], square_size_m: 0.095, plate_size_m: [0.61, 0.85]}
sensors:
  camera:
    type: camera
    intrinsics: {model: fisheye_kb4, fx_px: %r, fy_px: %r, cx_px: %r, cy_px: %r, distortion: %r}%s
  lidar:
    type: lidar%s
""" % (robot, k[0], k[4], k[2], k[5], d, "\n    T_ref_nominal: {p_m: [0, 0, 0], q_xyzw: [0, 0, 0, 1]}" if nominal else "",
       "\n    T_ref_nominal: " + nominal if nominal else ""))
    for sensor in ("camera", "lidar"):
        (folder / sensor).mkdir()
    for picture in sorted((source / "images").glob("*.png")):
        number = "%02d" % int(picture.stem.removeprefix("pose"))
        shutil.copyfile(picture, folder / "camera" / (number + ".png"))
        shutil.copyfile(source / "pcd" / (picture.stem + "_full.pcd"), folder / "lidar" / (number + ".pcd"))


def copy_board_points(source, folder):
    """The board's points only, named as the captures are."""
    folder.mkdir()
    for cloud in (source / "pcd").glob("*_target.pcd"):
        shutil.copyfile(cloud, folder / ("%02d.pcd" % int(cloud.stem.removeprefix("pose").removesuffix("_target"))))
