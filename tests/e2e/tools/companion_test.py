"""`rigcal companion` on a folder that fills, without a server: what it ends with, what it answers, and what it does not give away."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import check  # noqa: E402

RIGCAL = pathlib.Path(os.environ["RIGCAL_BIN"]) / "rigcal"
RIG = pathlib.Path(__file__).resolve().parents[3] / "deploy" / "measures" / "tools" / "companion_rig.yaml"
ENOUGH, USAGE, REFUSED, MORE = 0, 2, 4, 5


def rigcal(*words, exit_code):
    done = subprocess.run([str(RIGCAL), *map(str, words)], capture_output=True, text=True, timeout=300)
    check(done.returncode == exit_code, "rigcal %s: exit %d instead of %d: %s%s" % (
        " ".join(map(str, words)), done.returncode, exit_code, done.stdout, done.stderr))
    return done


def get(address):
    with urllib.request.urlopen(address, timeout=20) as reply:
        return reply.read()


def status_of(address):
    try:
        get(address)
    except urllib.error.HTTPError as error:
        return error.code
    return 200


def wait_for(address, ready):
    """The document once it is so."""
    end = time.monotonic() + 120
    while time.monotonic() < end:
        told = json.loads(get(address + "/api/v1/companion"))
        if ready(told):
            return told
    raise AssertionError("the companion does not come to it: " + json.dumps(told)[:2000])


def once(whole):
    rigcal("companion", whole / "nowhere", "--once", exit_code=REFUSED)
    rigcal("companion", whole, "--port", 70000, exit_code=USAGE)
    done = subprocess.run([str(RIGCAL), "companion", str(whole), "--once", "--json"], capture_output=True, text=True, timeout=300)
    told = json.loads(done.stdout)
    check(done.returncode == (ENOUGH if told["enough"] else MORE), "the code says what the document says: %d" % done.returncode)
    check(len(told["captures"]) == 4 and told["sensors"][0]["board_in"], "captures with the board: " + done.stdout[:1000])
    few = whole.parent / "few"
    shutil.copytree(whole, few)
    for path in [*few.glob("*/*.jpg")]:
        path.unlink()
    text = rigcal("companion", few, "--once", exit_code=MORE).stdout
    check("next     Hold the board " in text and "becomes known" in text, "what to begin with: " + text)


def grows(whole, growing):
    process = subprocess.Popen([str(RIGCAL), "companion", str(growing), "--port", "0", "--json"], stdout=subprocess.PIPE, text=True)
    try:
        address = json.loads(process.stdout.readline())["address"]
        wait_for(address, lambda told: "session.yaml" in told["headline"])
        shutil.copyfile(whole / "session.yaml", growing / "session.yaml")
        wait_for(address, lambda told: told["sensors"] and told["next"])
        for sensor in ("left", "right"):
            shutil.copytree(whole / sensor, growing / sensor)
        told = wait_for(address, lambda told: len(told["captures"]) == 4 and not told["looking"])
        check(all(sensor["is_known"] for sensor in told["sensors"]), "both are tied: " + json.dumps(told)[:2000])
        path = told["sensors"][0]["picture"]["path"]
        check(get(address + "/pictures/" + path) == (growing / path).read_bytes(), "the picture as it is")
        for hidden in ("session.yaml", "../growing/session.yaml", "left/none.jpg", "truth.yaml"):
            check(status_of(address + "/pictures/" + hidden) in (400, 404), "not given away: " + hidden)
    finally:
        process.terminate()
        check(process.wait(timeout=20) == 0, "it ends when it is told to")


def tells_who_sees_it(growing):
    process = subprocess.Popen([str(RIGCAL), "companion", str(growing), "--host", "0.0.0.0", "--port", "0", "--json"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    try:
        said = process.stderr.readline()
        check("0.0.0.0 from the network sees the pictures" in said, "that it is open to others is said: " + said)
    finally:
        process.terminate()
        process.communicate(timeout=20)


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-companion-") as name:
        whole, growing = pathlib.Path(name) / "whole", pathlib.Path(name) / "growing"
        growing.mkdir()
        rigcal("simulate", RIG, "--out", whole, "--captures", 4, "--scale", 0.3, exit_code=0)
        once(whole)
        grows(whole, growing)
        tells_who_sees_it(growing)
    print("companion: good")


main()
