"""The page of `rigcal companion` in Chromium, on a phone's screen, while captures come into its folder."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from stage import HERE, check, chromium, skip_without_browser

RIG = HERE.parents[1] / "deploy" / "measures" / "tools" / "companion_rig.yaml"
RIGCAL = pathlib.Path(os.environ["RIGCAL_BIN"]) / "rigcal"
STOPPED_WITHIN_S = 20


def simulate(folder):
    subprocess.run([str(RIGCAL), "simulate", str(RIG), "--out", str(folder), "--captures", "3", "--scale", "0.3"], check=True,
                   capture_output=True, timeout=300)


def start(folder):
    process = subprocess.Popen([str(RIGCAL), "companion", str(folder), "--port", "0", "--json"], stdout=subprocess.PIPE, text=True)
    return process, json.loads(process.stdout.readline())["address"]


def main():
    skip_without_browser()
    with tempfile.TemporaryDirectory(prefix="rigcal-companion-") as name:
        whole, growing = pathlib.Path(name) / "whole", pathlib.Path(name) / "growing"
        simulate(whole)
        growing.mkdir()
        process, address = start(growing)
        try:
            facts = {"address": address, "chromium": chromium(), "whole": str(whole), "growing": str(growing)}
            done = subprocess.run(["node", str(HERE / "companion.cjs"), json.dumps(facts)], capture_output=True, text=True, timeout=400)
            check(done.returncode == 0, "companion.cjs:\n" + done.stderr[-4000:])
        finally:
            process.terminate()
            check(process.wait(timeout=STOPPED_WITHIN_S) == 0, "it ends when it is told to")
        shutil.copyfile(whole / "session.yaml", growing / "session.yaml")
        once = subprocess.run([str(RIGCAL), "companion", str(growing), "--once"], capture_output=True, text=True, timeout=120)
        check(once.returncode in (0, 5) and "\nnext     " in once.stdout, "what it says once: " + once.stdout + once.stderr)
    print("companion: good")


if __name__ == "__main__":
    sys.exit(main())
