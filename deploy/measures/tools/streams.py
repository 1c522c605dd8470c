"""From stream to captures: free-running cameras (10, 15 and 30 Hz, clocks off by up to 40 ms and 20 ppm) before a board that a hand waves at
0.3 m/s, held now and then, or never. Pictures, stamps and truth are the simulator's; the bag's writer shares nothing with its reader."""
import json
import math
import pathlib

from .bags import session_bags, writer
from .import_bags import GOOD, MORE, REFUSED, rigcal_import
from ..measure import at_least, at_most, equal, info
from ..server import ANSWERED, Server

PLACES = 30
RATES_HZ = {"front": 30, "left": 15, "right": 10}
CLOCKS = [{"left": (0.027, 20e-6), "right": (-0.038, -20e-6)}, {"left": (-0.040, 12e-6), "right": (0.019, -7e-6)}, {"left": (0.008, -20e-6), "right": (0.040, 20e-6)}]
OFFSET_MS_MAX, SIGMAS_MAX = 1.0, 3.0


def clock_of(seed, sensor):
    """Offset in s and drift of a camera's clock against the reference's, which is right."""
    return CLOCKS[(seed - 1) % len(CLOCKS)].get(sensor, (0.0, 0.0))


def waved(context, folder, seed, hand):
    """What the simulator tells of the stream whose bag and rig.yaml it leaves in the folder."""
    numbers = [number for sensor, rate_hz in RATES_HZ.items() for number in (rate_hz, *clock_of(seed, sensor))]
    told = context.run_json("stream_frames", pathlib.Path(__file__).with_name("stream_rig.yaml"), folder, seed, PLACES, hand, *numbers, timeout=1800)
    messages = [("/" + sensor, log_ns, writer.compressed("cdr", stamp_ns, "jpeg", (folder / sensor / ("%d.jpg" % number)).read_bytes()))
                for sensor, number, stamp_ns, log_ns in told["frames"]]
    writer.mcap(folder / "stream.mcap", sorted(messages, key=lambda message: message[1]), session_bags.topics_of(folder, 2))
    (folder / "rig.yaml").write_text(session_bags.rig_of(folder, "stream-%d-%s" % (seed, hand)))
    return told


def imported(context, folder):
    """(exit code, the import's document, its seconds) of the bag there; the session is in folder/visit."""
    code, out, error, took_s = rigcal_import(context, folder / "stream.mcap", "--rig", folder / "rig.yaml", "--out", folder / "visit", "--json")
    if code not in (GOOD, MORE, REFUSED):
        raise RuntimeError("import: exit %d: %s" % (code, error[-300:]))
    return code, json.loads(out) if out else {}, took_s


def clock_errors_ms(told, document, seed):
    """(in ms, in its sigmas) of each camera's clock, at both ends of the stream; without an answer both are endless."""
    clocks = {clock["sensor"]: clock for clock in document.get("clocks", [])}
    for sensor in CLOCKS[0]:
        clock = clocks.get(sensor)
        for since_s in (0.0, told["duration_s"]):
            offset_s, drift = clock_of(seed, sensor)
            if not clock or clock.get("offset_s") is None:
                yield math.inf, math.inf
                continue
            at_s = since_s - (clock["at_ns"] - told["start_ns"]) * 1e-9
            error_s = clock["offset_s"] + clock["drift_ratio"] * at_s - (offset_s + drift * since_s)
            yield abs(error_s) * 1e3, abs(error_s) / math.hypot(clock["offset_sigma_s"], clock["drift_sigma_ratio"] * at_s)


def compared(context, folder, robot):
    """(worst error in sigmas, largest sigma in mm) of the poses that a server makes of the session; nothing of none."""
    with Server(context, folder / "store") as server:
        pushed = server.rigcal("push", folder / "visit", "--json", "--new-robot", timeout=1800)
        if pushed.returncode not in ANSWERED:
            return None
        done = server.rigcal("compare", robot, "--poses", folder / "truth.yaml", "--json")
    sensors = [sensor for sensor in json.loads(done.stdout or "{}").get("sensors", []) if sensor["id"] != "front"]
    if len(sensors) < 2 or any(sensor["sigma"] is None for sensor in sensors):
        return None
    return max(sensor["worst_sigmas"] for sensor in sensors), 1e3 * max(max(sensor["sigma"][:3]) for sensor in sensors)


def with_pauses(context, seeds):
    worst, sigmas_mm, clocks, captures, slowest_s = [], [], [], [], 0.0
    for seed in seeds:
        with context.folder() as name:
            folder = pathlib.Path(name)
            told = waved(context, folder, seed, "pauses")
            _, document, took_s = imported(context, folder)
            judged = compared(context, folder, "stream-%d-pauses" % seed)
            worst.append(judged[0] if judged else math.inf)
            sigmas_mm.append(judged[1] if judged else math.inf)
            clocks += clock_errors_ms(told, document, seed)
            captures.append(document.get("captures", 0))
            slowest_s = max(slowest_s, took_s / told["duration_s"])
    yield at_most("worst_error_in_sigmas", max(worst), SIGMAS_MAX)
    yield at_most("largest_sigma", max(sigmas_mm), 1.0, "mm")
    yield at_most("clock_error", max(error_ms for error_ms, _ in clocks), OFFSET_MS_MAX, "ms")
    yield at_most("clock_error_in_sigmas", max(in_sigmas for _, in_sigmas in clocks), SIGMAS_MAX)
    yield at_least("captures_of_%d_pauses" % PLACES, min(captures), 0.8 * PLACES)
    yield info("import_seconds_per_second_of_stream", slowest_s)


def without_pauses(context, seeds):
    """Refused, or honest about what a moving board makes of it."""
    refused, dishonest = 0, []
    for seed in seeds:
        with context.folder() as name:
            folder = pathlib.Path(name)
            waved(context, folder, seed, "wandering")
            code, document, _ = imported(context, folder)
            judged = compared(context, folder, "stream-%d-wandering" % seed) if code != REFUSED else None
            refused += judged is None
            if judged and judged[0] > SIGMAS_MAX:
                dishonest.append("seed %d: %.1f sigmas of %d captures" % (seed, judged[0], document["captures"]))
    yield equal("never_held_dishonest_of_%d" % len(seeds), len(dishonest), 0, dishonest)
    yield info("never_held_refused", refused)


def run(context):
    seeds = list(range(1, 7 if context.full else 3))
    yield from with_pauses(context, seeds)
    yield from without_pauses(context, seeds[:3 if context.full else 1])
