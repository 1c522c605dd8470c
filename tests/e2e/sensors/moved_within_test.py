"""A camera gives way in the middle of a visit: the robot fails, the camera and the captures are named, on the page too; the same visit
without it passes; a later visit that says that the camera was remounted clears it."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from front_rig import front_rig  # noqa: E402

MOVED = "front_right"


def simulate(flow, name, seed, captured_at, *more):
    flow.rigcal("simulate", front_rig(flow, "bumped", name), "--out", flow.folder / name, "--seed", seed, "--captures", 20, "--scale", 0.3,
                "--captured-at", captured_at, *more)
    return flow.folder / name


def verdict(flow, exit_code=None):
    return json.loads(flow.rigcal("show", "bumped", "--json", exit_code=exit_code).stdout)["document"]["verdict"]


def main():
    with Flow() as flow:
        clean = simulate(flow, "clean", 1, "2026-01-31")
        flow.rigcal("push", clean)
        before = verdict(flow)
        check("moved" not in before["why"], "nothing moved: %r" % before)
        bumped = simulate(flow, "bumped", 2, "2026-02-03", "--bump", MOVED, "--bump-by", "0.005,0.5")
        flow.rigcal("push", bumped, exit_code=1)
        found = verdict(flow, exit_code=1)
        check(found["level"] == "fail" and "ront_right was moved during the session of 2026-02-03" in found["why"], "named: %r" % found)
        check("between captures 10 and 11" in found["why"] or "between captures 11 and 12" in found["why"], "when: %r" % found)
        check("--remounted " + MOVED in found["what_to_do"], "what to do: %r" % found)
        number = json.loads(flow.rigcal("show", "bumped", "--json", exit_code=1).stdout)["revision"]
        check("was moved during the session" in flow.get("/robots/bumped/revisions/%d/" % number), "the report says so")
        shown = json.loads(flow.rigcal("show", "bumped", "--json", exit_code=1).stdout)
        check(shown["usable"] is None, "what was known before the sensor gave way is nothing to fall back to: %r" % shown["usable"])
        flow.kill_and_restart()
        check(verdict(flow, exit_code=1) == found, "after a restart, too")
        mended = simulate(flow, "mended", 3, "2026-02-05")
        flow.server.rigcal("push", mended, "--remounted", MOVED)
        after = json.loads(flow.server.rigcal("show", "bumped", "--json").stdout)
        check(after["revision"] > number, "there is a new revision: %r" % after["revision"])
        check("moved during" not in after["document"]["verdict"]["why"], "what was before the remount is past: %r" % after["document"]["verdict"])
    print("moved_within: good")


main()
