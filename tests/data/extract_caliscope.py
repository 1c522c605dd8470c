#!/usr/bin/env python3
"""Makes a session folder (docs/session-format.md) of a four-camera recording of a ChArUco board.

extract_caliscope.py SOURCE OUT [--frames N]

SOURCE has camera_array.toml, charuco.toml and calibration/extrinsic/ with cam_<id>.mp4, timestamps.csv and xy.csv. OUT gets
session.yaml and <camera>/<capture>.png: N captures (24), chosen evenly among those in which at least two cameras see six
corners of the board by xy.csv. Needs ffmpeg. A folder that is there is replaced file by file.
"""
import argparse
import collections
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

CORNERS_MIN = 6
CAMERAS_MIN = 2


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def frames_of(folder):
    """{camera: [sync index of frame 0, of frame 1, ...]}: the videos hold the frames of timestamps.csv in their order."""
    frames = collections.defaultdict(list)
    for row in rows(folder / "timestamps.csv"):
        frames[int(row["cam_id"])].append(int(row["sync_index"]))
    return {camera: sorted(indices) for camera, indices in sorted(frames.items())}


def seen_together(folder, frames):
    """Sync indices of which every camera has a frame, and in which enough cameras see enough of the board."""
    corners = collections.Counter((int(row["sync_index"]), int(row["cam_id"])) for row in rows(folder / "xy.csv"))
    cameras = collections.Counter(sync for (sync, _), count in corners.items() if count >= CORNERS_MIN)
    complete = set.intersection(*(set(indices) for indices in frames.values()))
    return sorted(sync for sync in complete if cameras[sync] >= CAMERAS_MIN)


def evenly(items, count):
    if len(items) <= count:
        return items
    if count == 1:
        return items[:1]
    return [items[round(i * (len(items) - 1) / (count - 1))] for i in range(count)]


def extract(video, wanted, out):
    """wanted: {frame number: capture}. Frames as stored: intrinsics belong to the grid before any rotation."""
    out.mkdir(parents=True, exist_ok=True)
    select = "+".join(f"eq(n\\,{number})" for number in sorted(wanted))
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-noautorotate", "-i", str(video), "-vf",
                        f"select={select}", "-vsync", "0", f"{scratch}/%06d.png"], check=True)
        pictures = sorted(pathlib.Path(scratch).iterdir())
        if len(pictures) != len(wanted):
            sys.exit(f"{video}: {len(pictures)} of {len(wanted)} frames could be read")
        for number, picture in zip(sorted(wanted), pictures):
            shutil.copyfile(picture, out / f"{wanted[number]}.png")


def target_lines(board):
    square_m = board["square_size_override_cm"] / 100
    fields = {"type": "charuco", "squares": [board["columns"], board["rows"]], "square_size_m": round(square_m, 6),
              "marker_size_m": round(square_m * board["aruco_scale"], 6), "dictionary": board["dictionary"],
              "legacy_layout": board["legacy_pattern"]}
    return [f"    {key}: {json.dumps(value)}" for key, value in fields.items()]


def camera_lines(camera):
    matrix = camera["matrix"]
    fields = {"model": "pinhole_radtan", "fx_px": matrix[0][0], "fy_px": matrix[1][1], "cx_px": matrix[0][2],
              "cy_px": matrix[1][2], "distortion": camera["distortions"]}
    return ["    type: camera", "    intrinsics:"] + [f"      {key}: {json.dumps(value).strip(chr(34))}"
                                                      for key, value in fields.items()]


def session_yaml(source, cameras):
    with open(source / "charuco.toml", "rb") as file:
        board = tomllib.load(file)
    with open(source / "camera_array.toml", "rb") as file:
        array = tomllib.load(file)["cameras"]
    lines = ["format: 1", "robot: caliscope-rig", f"captured_at: {captured_at(source)}", "reference: cam_0",
             "targets:", "  board:"] + target_lines(board) + ["sensors:"]
    for camera in cameras:
        lines += [f"  cam_{camera}:"] + camera_lines(array[str(camera)])
    return "\n".join(lines) + "\n"


def captured_at(source):
    with open(source / "config.toml", "rb") as file:
        return tomllib.load(file)["CreationDate"].isoformat(timespec="seconds") + "Z"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=24)
    options = parser.parse_args()
    folder = options.source / "calibration" / "extrinsic"
    frames = frames_of(folder)
    chosen = evenly(seen_together(folder, frames), options.frames)
    if not chosen:
        sys.exit(f"{folder}: no frames in which {CAMERAS_MIN} cameras see the board")
    for camera, indices in frames.items():
        wanted = {indices.index(sync): f"{sync:06d}" for sync in chosen}
        extract(folder / f"cam_{camera}.mp4", wanted, options.out / f"cam_{camera}")
    (options.out / "session.yaml").write_text(session_yaml(options.source, list(frames)), encoding="utf-8")
    print(f"{options.out}: {len(chosen)} captures of {len(frames)} cameras")


if __name__ == "__main__":
    main()
