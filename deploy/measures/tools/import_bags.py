"""Bags: the same poses as the folder from every container, a large one by speed, memory and resumption, the format's own files, damage."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

from ..measure import at_least, at_most, equal, info, skip
from ..server import ANSWERED, Server
from ..service.push import PAYLOAD_BYTES, disk_alone
from .bags import big_bag, session_bags

GOOD, REFUSED, MORE = 0, 4, 5
CONFORMANCE_FILES = 171
POSE_DIFFERENCE_MAX = 1e-9
WIDTH, HEIGHT = 1920, 1200


def rigcal_import(context, *words, timeout=3600):
    """Exit code, stdout, stderr, seconds."""
    began = time.monotonic()
    with subprocess.Popen([str(context.bin / "rigcal"), "import", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        out, err = process.communicate(timeout=timeout)
    return process.returncode, out, err, time.monotonic() - began


def peak_mib(command):
    """Peak memory of a command that succeeds, as the system counted it."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != GOOD:
        raise RuntimeError("%s: exit %d" % (command[1], process.returncode))
    return usage.ru_maxrss / 1024


def poses_of(server, robot):
    """{name: numbers} of every edge and every sensor that is known."""
    document = json.loads(server.rigcal("show", robot, "--whole", "--json").stdout)["document"]
    poses = {"%s %s" % (edge["frame_a"], edge["frame_b"]): edge["T_a_b"] for edge in document["edges"] if edge.get("T_a_b")}
    poses.update({sensor["id"]: sensor["T_ref_sensor"] for sensor in document["sensors"] if sensor.get("T_ref_sensor")})
    return {name: [*pose["p_m"], *pose["q_xyzw"]] for name, pose in poses.items()}


def pushed(context, store, robot, *words):
    with Server(context, store) as server:
        done = server.rigcal("push", *words, timeout=1800)
        if done.returncode not in ANSWERED:
            raise RuntimeError("push: exit %d: %s" % (done.returncode, done.stderr[-300:]))
        return poses_of(server, robot)


def largest_difference(poses, wanted):
    if poses.keys() != wanted.keys():
        return float("inf")
    return max(abs(a - b) for name in wanted for a, b in zip(poses[name], wanted[name]))


def same_poses(context, folder):
    session, rig = folder / "visit", folder / "rig.yaml"
    captures = 30 if context.full else 12
    context.run_json("rigcal", "simulate", "mars-mapper", "--out", session, "--scale", 0.5, "--captures", captures, "--json", timeout=1800)
    rig.write_text(session_bags.rig_of(session))
    wanted = pushed(context, folder / "store", "mars-mapper", session)
    yield at_least("poses_of_the_folder", len(wanted), 12)
    for container, bag in session_bags.bags_of(session, folder).items():
        poses = pushed(context, folder / ("store-" + container), "mars-mapper", bag, "--rig", rig)
        yield at_most("pushed_as_%s_largest_difference" % container, largest_difference(poses, wanted), POSE_DIFFERENCE_MAX)
    yield equal("folders_left_beside_bags", len(list(folder.glob("*.rigcal-push"))), 0)


def killed_amid(context, bag, rig, out, files):
    """Ends an import with SIGKILL once it has written so many files."""
    process = subprocess.Popen([str(context.bin / "rigcal"), "import", str(bag), "--rig", str(rig), "--out", str(out)], stdout=subprocess.DEVNULL)
    try:
        until = time.monotonic() + 3600
        while process.poll() is None and time.monotonic() < until and len(list(out.glob("front/*.jpg"))) < files:
            time.sleep(0.02)
        if process.poll() is not None:
            raise RuntimeError("the import ended before it was killed: exit %d" % process.returncode)
    finally:
        process.send_signal(signal.SIGKILL)  # of one that has ended: nothing
        process.wait()


def large(context, folder):
    total_bytes = 10_000_000_000 if context.full else 1_000_000_000
    count = total_bytes // PAYLOAD_BYTES
    bag, rig, out = folder / "large.mcap", folder / "rig.yaml", folder / "out"
    rig.write_text(big_bag.RIG)
    big_bag.of_jpeg(bag, count, PAYLOAD_BYTES)
    killed_amid(context, bag, rig, out, count // 3)
    code, text, error, _ = rigcal_import(context, bag, "--rig", rig, "--out", out, "--json")
    if code != GOOD:
        raise RuntimeError("import: exit %d: %s" % (code, error[-300:]))
    yield at_least("files_kept_after_kill", json.loads(text)["kept_files"], count // 3)
    whole = [path for path in out.glob("front/*.jpg") if path.stat().st_size == PAYLOAD_BYTES]
    yield equal("files_whole_after_kill", "%d/%d" % (len(whole), count), "%d/%d" % (count, count))
    shutil.rmtree(out)
    yield at_most("import_peak_rss", peak_mib([context.bin / "rigcal", "import", bag, "--rig", rig, "--out", out]), 500.0, "MiB")
    shutil.rmtree(out)
    disk = disk_alone(context, folder / "disk", min(count, 333))
    shutil.rmtree(folder / "disk")
    _, _, _, took_s = rigcal_import(context, bag, "--rig", rig, "--out", out)
    shutil.rmtree(out)
    rate = count * PAYLOAD_BYTES / took_s
    yield info("disk_alone", disk / 1e6, "MB/s")
    yield info("import_of_jpeg", rate / 1e6, "MB/s")
    yield at_least("import_of_jpeg_share_of_disk", rate / disk, 0.6)


def raw_pictures(context, folder):
    """Against the same pictures encoded as PNG alone, and against the disk for what comes out."""
    count = 1000 if context.full else 150
    pixels, bag, rig, out = big_bag.noisy_pixels(WIDTH, HEIGHT), folder / "raw.mcap", folder / "rig.yaml", folder / "raw"
    rig.write_text(big_bag.RIG)
    (folder / "pixels").write_bytes(pixels)
    big_bag.of_pixels(bag, count, WIDTH, HEIGHT, pixels)
    encoding = context.run_json("png_bench", folder / "pixels", WIDTH, HEIGHT, min(count, 150))["bytes_per_s"]
    code, _, error, took_s = rigcal_import(context, bag, "--rig", rig, "--out", out)
    if code != GOOD:
        raise RuntimeError("import: exit %d: %s" % (code, error[-300:]))
    files = list(out.glob("front/*.png"))
    yield equal("raw_pictures", len(files), count)
    packed = sum(path.stat().st_size for path in files) / (count * len(pixels))
    disk = disk_alone(context, folder / "disk", 100) / packed
    rate = count * len(pixels) / took_s
    yield info("png_alone", encoding / 1e6, "MB/s")
    yield info("import_of_raw_pictures", rate / 1e6, "MB/s")
    yield at_least("import_of_raw_pictures_share", rate / min(encoding, disk), 0.6)
    peak = peak_mib([context.bin / "rigcal", "import", bag, "--rig", rig, "--out", folder / "again"])
    yield at_most("import_of_raw_pictures_peak_rss", peak, 500.0, "MiB")


def records_as_json(context):
    """Every field of every record, by the unit test that has them."""
    program = context.bin / "bags_test"
    if not program.exists():
        return skip("conformance_records_as_json", "bags_test is not built")
    done = subprocess.run([str(program), "--gtest_filter=McapConformance.*"], capture_output=True, text=True, timeout=600)
    passed = done.returncode == 0 and "[  PASSED  ] 1 test." in done.stdout and "SKIPPED" not in done.stdout
    return equal("conformance_records_as_json", "yes" if passed else "no", "yes")


def conformance(context):
    folder = context.data / "bags" / "mcap_conformance"
    if not folder.is_dir():
        yield skip("conformance", "no data in bags/mcap_conformance")
        return
    yield records_as_json(context)
    files, wrong = sorted(folder.rglob("*.mcap")), []
    for path in files:
        told = json.loads(path.with_suffix(".json").read_text())["records"]
        code, text, _, _ = rigcal_import(context, path, "--list", "--json")
        messages = sum(record["type"] == "Message" for record in told)
        if code != GOOD or json.loads(text)["messages"] != messages:
            wrong.append(path.name)
    yield equal("conformance_messages", "%d/%d" % (len(files) - len(wrong), len(files)), "%d/%d" % (CONFORMANCE_FILES, CONFORMANCE_FILES), wrong)


def small_bags(folder):
    """Whole bags of every container, each with a dozen poses."""
    pose = {ros: {"/body": ("geometry_msgs/PoseStamped" if ros == 1 else "geometry_msgs/msg/PoseStamped",
                            session_bags.writer.definition("geometry_msgs/PoseStamped", ros))} for ros in (1, 2)}

    def messages(form):
        stamps = [big_bag.START_NS + k * big_bag.PERIOD_NS for k in range(12)]
        return [("/body", stamp, session_bags.writer.pose(form, stamp, (1, 2, 3), (0, 0, 0, 1))) for stamp in stamps]
    session_bags.writer.mcap(folder / "small.mcap", messages("cdr"), pose[2])
    session_bags.writer.database(folder / "small.db3", messages("cdr"), pose[2], 4)
    session_bags.writer.ros1(folder / "small.bag", messages("ros1"), pose[1])
    return [folder / name for name in ("small.mcap", "small.db3", "small.bag")]


def damaged_bags(context, folder):
    """Every recorded one, and whole ones cut off at several places."""
    recorded = context.data / "bags" / "formats"
    paths = [path for path in (recorded / "truncated" / "test_sample_truncated.mcap", recorded / "ros1_fixtures" / "empty-file.bag") if path.exists()]
    for bag in small_bags(folder):
        data = bag.read_bytes()
        for share in (0.0, 0.3, 0.6, 0.9):
            cut = folder / ("cut_%d_%s" % (100 * share, bag.name))
            cut.write_bytes(data[:int(share * len(data))])
            paths.append(cut)
    (folder / "no_bag.mcap").write_text("hello, this is no bag\n")
    return paths + [folder / "no_bag.mcap"]


def damage(context, folder):
    wrong = []
    paths = damaged_bags(context, folder)
    for path in paths:
        code, _, error, _ = rigcal_import(context, path, "--list", "--json")
        if code not in (REFUSED, MORE) or error.count("\n") != 1 or not error.startswith("rigcal: "):
            wrong.append("%s: exit %d: %s" % (path.name, code, error.strip()))
    yield equal("damaged_bags_with_one_sentence", "%d/%d" % (len(paths) - len(wrong), len(paths)), "%d/%d" % (len(paths), len(paths)), wrong)


def run(context):
    yield from conformance(context)
    for part in (damage, same_poses, large, raw_pictures):
        with context.folder() as name:
            yield from part(context, pathlib.Path(name))
