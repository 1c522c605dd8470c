"""`rigcal import` of cameras that run freely: one capture for each place where the board is held, the rest told; a board that is never held is refused."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import check  # noqa: E402
from measures.tools.bags import writer as bag_writer  # noqa: E402

RIGCAL = pathlib.Path(os.environ["RIGCAL_BIN"]) / "rigcal"
GOOD, REFUSED = 0, 4
START_NS = 1_700_000_000_000_000_000
WIDTH, HEIGHT, SQUARE, COLUMNS, ROWS = 240, 160, 14, 10, 7
PERIOD_NS = {"left": 50_000_000, "right": 100_000_000}
RIGHT_LATER_NS, PLACES, HELD_S, MOVED_S, STEP_PX = 23_000_000, 5, 1.0, 0.6, 14
RIG = """format: 1
robot: mapper-01
import: {%s}
targets:
  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.03}
sensors:
  left: {type: camera, topic: /left/image_raw, sees: board}
  right: {type: camera, topic: /right/image_raw, sees: board}
"""


def rigcal(*words, exit_code=GOOD):
    done = subprocess.run([str(RIGCAL), *map(str, words)], capture_output=True, text=True, timeout=300)
    check(done.returncode == exit_code, "rigcal %s: exit %d instead of %d: %s%s" % (
        " ".join(map(str, words)), done.returncode, exit_code, done.stdout, done.stderr))
    return done


def picture(x_px, y_px=30):
    """A checkerboard whose corner stands there, on white."""
    def row(dark_first):
        squares = b"".join(bytes([30 if (i + dark_first) % 2 else 220]) * SQUARE for i in range(COLUMNS))
        return (bytes([220]) * x_px + squares + bytes([220]) * WIDTH)[:WIDTH]
    white, kinds = bytes([220]) * WIDTH, (row(0), row(1))
    return b"".join(kinds[(y - y_px) // SQUARE % 2] if 0 <= y - y_px < ROWS * SQUARE else white for y in range(HEIGHT))


def held(t_s):
    """Where the board is that is held, then moved, and so on."""
    place, since_s = divmod(t_s, HELD_S + MOVED_S)
    return round(STEP_PX * (place + max(0.0, since_s - HELD_S) / MOVED_S))


def waved(t_s):
    return round(35 + 35 * (1 - abs(1 - t_s * 1.1 % 2)))


def write_bag(path, place_at):
    messages, duration_ns = [], round(PLACES * (HELD_S + MOVED_S) * 1e9) - round(MOVED_S * 1e9)
    for camera, period_ns in PERIOD_NS.items():
        for t_ns in range(RIGHT_LATER_NS if camera == "right" else 0, duration_ns, period_ns):
            data = bag_writer.image("cdr", START_NS + t_ns, WIDTH, HEIGHT, "mono8", picture(10 + place_at(t_ns * 1e-9)), WIDTH)
            messages.append(("/%s/image_raw" % camera, START_NS + t_ns, data))
    kinds = {"/%s/image_raw" % camera: ("sensor_msgs/msg/Image", bag_writer.definition("sensor_msgs/Image", 2)) for camera in PERIOD_NS}
    bag_writer.mcap(path, sorted(messages, key=lambda message: message[1]), kinds)


def check_choice(folder, bag):
    (folder / "rig.yaml").write_text(RIG % "moments: auto")
    words = ("import", bag, "--rig", folder / "rig.yaml", "--out", folder / "visit", "--json")
    told = json.loads(rigcal(*words).stdout)
    check(told["captures"] == PLACES, "one capture for each place: " + json.dumps(told))
    moments = told["moments"]
    check(moments["left_out"]["moved"] > 10 and moments["left_out"]["same_place"] > 10, "the others are told: " + json.dumps(moments))
    check(moments["chosen"] + sum(moments["left_out"].values()) == moments["all"], "every moment is told: " + json.dumps(moments))
    for sensor in told["sensors"]:
        check(sensor["written"] == PLACES, "each camera has its picture of each: " + json.dumps(sensor))
        told_of = sum(sensor[key] for key in ("written", "without_partner", "repeated_stamps", "thinned_out", "left_out"))
        check(told_of == sensor["messages"], "every message is told: " + json.dumps(sensor))
    check(len(list((folder / "visit" / "left").glob("*.png"))) == PLACES, "as many files")
    session = (folder / "visit" / "session.yaml").read_text()
    check(moments["text"] in session and "camera_clocks" in session, "the session tells it: " + session)
    again = json.loads(rigcal(*words).stdout)
    check(again["was_complete"] and again["moments"] == moments and again["clocks"] == told["clocks"], "told again as it was: " + json.dumps(again))
    shown = rigcal("import", bag, "--rig", folder / "rig.yaml", "--out", folder / "visit").stdout
    check("Left out: " in shown and "something moved" in shown and "still moments" in shown, "people read it: " + shown)


def check_all(folder, bag):
    (folder / "all.yaml").write_text(RIG % "moments: all, tolerance_s: 0.03")
    told = json.loads(rigcal("import", bag, "--rig", folder / "all.yaml", "--out", folder / "all", "--json").stdout)
    check(told["captures"] > 10 * PLACES and "moments" not in told, "all that have a partner: " + json.dumps(told))


def check_no_board(folder):
    write_bag(folder / "empty.mcap", lambda _: WIDTH)
    done = json.loads(rigcal("import", folder / "empty.mcap", "--rig", folder / "rig.yaml", "--out", folder / "empty", "--json", "--tolerance", 0.03).stdout)
    check(done["shows_no_board"] and "moments" not in done and done["captures"] > 10 * PLACES, "without a board by stamps, and told: " + json.dumps(done))


def check_refusal(folder):
    write_bag(folder / "waved.mcap", waved)
    done = rigcal("import", folder / "waved.mcap", "--rig", folder / "rig.yaml", "--out", folder / "none", exit_code=REFUSED)
    check("no still moment" in done.stderr and "allowed are 1.00 mm, 0.50 px" in done.stderr, "refused with its figure: " + done.stderr)
    check(not (folder / "none" / "session.yaml").exists(), "no session is left")


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-e2e-") as name:
        folder = pathlib.Path(name)
        write_bag(folder / "held.mcap", held)
        check_choice(folder, folder / "held.mcap")
        check_all(folder, folder / "held.mcap")
        check_no_board(folder)
        check_refusal(folder)
    print("import_stream: good")


main()
