"""Durable push of 3 MB payloads against the disk alone and the wire alone, in the same run; memory while 1 GB arrives."""
import json
import os
import pathlib
import re
import subprocess
import time
import uuid

from ..measure import at_least, at_most, equal, info, skip
from ..server import ANSWERED, Server
from ..sessions import noise_session, padded_session

PAYLOAD_BYTES = 3_000_000
SECONDS = 4


def disk_alone(context, folder, count):
    """bytes/s of write, fsync, rename, fsync of the folder, file after file."""
    folder.mkdir()
    return context.run_json("durable_write_bench", folder, PAYLOAD_BYTES, count)["bytes_per_s"]


def wire_alone(context):
    """bytes/s that tuned ddsperf moves in samples of the same size, under our own DDS configuration."""
    configuration = (context.root / "deploy" / "dds" / "default.xml").read_text()
    tag = "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces></General><Discovery><Tag>%s</Tag></Discovery></Domain></CycloneDDS>" % uuid.uuid4().hex
    environment = {**os.environ, "CYCLONEDDS_URI": configuration.strip() + "," + tag}
    commands = [["ddsperf", "-D", str(SECONDS), "sub"], ["ddsperf", "-D", str(SECONDS), "pub", "size", str(PAYLOAD_BYTES)]]
    subscriber, publisher = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
                             for command in commands]
    text = subscriber.communicate(timeout=60)[0]
    publisher.communicate(timeout=60)
    rates = [float(rate) * 1e6 / 8 for rate in re.findall(r"rate [\d.]+ kS/s ([\d.]+) Mb/s", text)]
    if not rates:
        raise RuntimeError("ddsperf received nothing: " + text[-300:])
    return max(rates)


def push(server, session):
    """Seconds from the first receipt to the closed session, as the client reports them, and the whole process's."""
    start = time.perf_counter()
    done = server.rigcal("push", session, "--no-wait", "--json")
    whole_s = time.perf_counter() - start
    if done.returncode != 0:
        raise RuntimeError("push: exit %d: %s" % (done.returncode, done.stderr[-300:]))
    return json.loads(done.stdout), whole_s


def run(context):
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        total_bytes = 1_000_000_000
        count = total_bytes // PAYLOAD_BYTES
        session = noise_session(folder / "session", "big", PAYLOAD_BYTES, count, seed=1)
        disk = disk_alone(context, folder / "disk", count)
        wire = wire_alone(context)
        with Server(context, folder / "store") as server:
            document, whole_s = push(server, session)
            rate = (document["total"] - document["held_before"]) / (document["transfer_ns"] * 1e-9)
            yield info("disk_alone", disk / 1e6, "MB/s")
            yield info("ddsperf_tuned", wire / 1e6, "MB/s")
            yield info("durable_push", rate / 1e6, "MB/s")
            yield info("durable_push_with_hashing_and_start", count * PAYLOAD_BYTES / whole_s / 1e6, "MB/s")
            yield at_least("share_of_the_smaller", rate / min(disk, wire), 0.6)
            yield equal("payloads", document["items"], count)
            again, _ = push(server, session)
            yield equal("bytes_sent_by_a_second_push", again["total"] - again["held_before"], 0)
            yield at_most("server_peak_rss_1GB", server.peak_rss_mib(), 300.0, "MiB")
        yield from memory_with_calibration(context, folder, count)


def memory_with_calibration(context, folder, count):
    """The same gigabyte as pictures that decode: memory until the last edge is done."""
    pictures = context.data / "stereo_opencv"
    if not pictures.is_dir():
        yield skip("server_peak_rss_1GB_calibrated", "no data in stereo_opencv")
        return
    session = padded_session(folder / "pictures", "pictures", pictures, PAYLOAD_BYTES, count, seed=2)
    with Server(context, folder / "picture-store") as server:
        done = server.rigcal("push", session)
        if done.returncode not in ANSWERED:
            raise RuntimeError("push: exit %d: %s" % (done.returncode, done.stderr[-300:]))
        yield at_most("server_peak_rss_1GB_calibrated", server.peak_rss_mib(), 300.0, "MiB")
