"""`rigcal check` on what a virtual robot recorded, without a server: what it ends with, what it says, and that a push says the same."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import check  # noqa: E402
from front_rig import front_rig  # noqa: E402

RIGCAL = pathlib.Path(os.environ["RIGCAL_BIN"]) / "rigcal"
GOOD, REFUSED, MORE = 0, 4, 5


class Place:
    """What front_rig wants of a flow, without a server."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def rigcal(self, *words, exit_code=GOOD):
        done = subprocess.run([str(RIGCAL), *map(str, words)], capture_output=True, text=True, timeout=300)
        check(done.returncode == exit_code, "rigcal %s: exit %d instead of %d: %s%s" % (
            " ".join(map(str, words)), done.returncode, exit_code, done.stdout, done.stderr))
        check("Traceback" not in done.stderr and "terminate called" not in done.stderr, "no stack trace: " + done.stderr)
        return done

    def simulate(self, name, rig, *more):
        self.rigcal("simulate", rig, "--out", self.folder / name, "--scale", 0.3, *more)
        return self.folder / name


def copied(session, name):
    copy = session.parent / name
    shutil.copytree(session, copy)
    return copy


def good_and_too_short(place, rig):
    good = place.simulate("good", rig, "--captures", 20)
    told = place.rigcal("check", good)
    check("\nverdict  Enough.\n" in told.stdout, "the verdict comes first: " + told.stdout)
    document = json.loads(place.rigcal("check", good, "--json").stdout)
    check(document["enough"] and document["advice"] == [] and document["captures_more"] == 0, "enough: %r" % document["advice"])
    check(all(pair["state"] == "good" and max(pair["sigma_m"]) < 0.005 for pair in document["pairs"]), "pairs: %r" % document["pairs"])
    short = json.loads(place.rigcal("check", place.simulate("short", rig, "--captures", 3), "--json", exit_code=MORE).stdout)
    check(not short["enough"] and short["captures_more"] == 17, "twenty are wanted: %r" % short["advice"])
    return good


def missing_half(place, good):
    half = copied(good, "half")
    for capture in range(4, 21):
        (half / "front_left" / ("%02d.jpg" % capture)).unlink()
    told = place.rigcal("check", half, exit_code=MORE).stdout
    check("front_left: files for 3 of 20 captures: 04 to 20 are missing; unless it took no part in these, as in another pass, copy these files into front_left/, or take these captures again." in told, "what is missing: " + told)
    check("Show the whole board" not in told and "more captures" not in told.split("files ")[0], "no other cure: " + told)


def none_readable(place, good):
    cut = copied(good, "cut")
    for path in (cut / "front_right").iterdir():
        path.write_bytes(path.read_bytes()[:500])
    document = json.loads(place.rigcal("check", cut, "--json", exit_code=MORE).stdout)
    check(document["captures_more"] == 0 and "20 of 20 pictures cannot be read: copy them again" in document["advice"][0]["text"], "unreadable: %r" % document["advice"])


def no_such_board(place, good):
    other = copied(good, "other")
    header = other / "session.yaml"
    header.write_text(header.read_text().replace("inner_corners: [10, 7]", "inner_corners: [11, 7]"))
    told = place.rigcal("check", other, exit_code=MORE).stdout
    check("board front with 11 x 7 inner corners was not found in any of the " in told and "correct `inner_corners` in session.yaml." in told, "counted wrong: " + told)
    check("Take" not in told, "no captures help: " + told)


def frontal(place, rig):
    text = rig.read_text()
    plain = text.replace("yaw_range_deg: 16", "yaw_range_deg: 0").replace("tilt_rms_deg: 5", "tilt_rms_deg: 0")
    plain = plain.replace("rpy_deg: [3, 12, -10]", "rpy_deg: [0, 0, 0]")
    check(plain.count("rpy_deg: [0, 0, 0]") == 1, "the board to the front is upright")
    straight = place.folder / "straight.yaml"
    straight.write_text(plain)
    told = place.rigcal("check", place.simulate("frontal", straight, "--captures", 12, "--intrinsics", "absent"), exit_code=MORE).stdout
    check("tilt the board 30 degrees" in told, "boards that stand alike: " + told)


def refused_as_a_push(place, good):
    bad = copied(good, "bad")
    (bad / "front_left" / "02.jpg").write_bytes(b"")
    told = place.rigcal("check", bad, exit_code=REFUSED)
    pushed = place.rigcal("push", bad, "--timeout-total", 1, exit_code=REFUSED)
    check(told.stderr == pushed.stderr and "02.jpg\": it is empty" in told.stderr, "%r, %r" % (told.stderr, pushed.stderr))
    check("A push refuses this folder (1 reason, above)" in told.stdout and "Pairs, as the server" in told.stdout, "the rest: " + told.stdout)
    document = json.loads(place.rigcal("check", bad, "--json", exit_code=REFUSED).stdout)
    check(len(document["refused"]) == 1 and not document["enough"], "refused: %r" % document["refused"])
    place.rigcal("check", place.folder / "nowhere", exit_code=REFUSED)
    for verb in ("check", "push"):
        told = place.rigcal(verb, good / "session.yaml", exit_code=REFUSED).stderr
        check("session.yaml\": it is no folder. Give the folder that holds session.yaml." in told, "a file of the folder: " + told)


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-check-") as folder:
        place = Place(folder)
        rig = front_rig(place, "checked", "rig")
        good = good_and_too_short(place, rig)
        missing_half(place, good)
        none_readable(place, good)
        no_such_board(place, good)
        frontal(place, rig)
        refused_as_a_push(place, good)
    print("check: good")


main()
