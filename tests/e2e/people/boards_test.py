"""A board's life: printed, used before anybody measured it, measured, corrected; what is marked, and what depends on it. A kill in between
loses nothing that was answered."""
import datetime
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, stereo_pairs, wait_published  # noqa: E402
from measures.sessions import picture_session  # noqa: E402

ROBOT, SERIAL = "stereo", "B-7"
WHAT = ("--type", "checkerboard", "--cols", 9, "--rows", 6, "--square-mm", 25)
REFUSED = 4


def measure(flow, x_mm, y_mm, *more, exit_code=None):
    return flow.rigcal("board", "measure", SERIAL, "--ruler-x-mm", x_mm, "--ruler-y-mm", y_mm, "--by", "Ada", *more, exit_code=exit_code)


def prints(flow):
    out = flow.folder / "board.pdf"
    said = json.loads(flow.rigcal("board", "print", *WHAT, "--serial", SERIAL, "--paper", "A3", "--out", out, "--json").stdout)
    check(out.read_bytes().startswith(b"%PDF-"), "a PDF was written")
    check(said["paper"] == "A3" and said["ruler_x_m"] == 0.2 and said["ruler_y_m"] == 0.3, "on A3, with rulers: %r" % said)
    again = flow.folder / "again.svg"
    flow.rigcal("board", "print", *WHAT, "--serial", SERIAL, "--out", again)
    check('width="' in again.read_text() and SERIAL in again.read_text(), "an SVG was written")
    refused = flow.rigcal("board", "print", *WHAT[:-1], 250, "--serial", SERIAL, "--paper", "A4", "--out", out, exit_code=REFUSED).stderr
    check("does not fit on A4" in refused, "what does not fit is refused: " + refused)


def with_serial(session):
    text = (session / "session.yaml").read_text()
    changed, count = re.subn(r"(square_size_m: *[0-9.]+)", r"\1, serial: %s" % SERIAL if "{" in text else r"\1\n    serial: %s" % SERIAL, text, count=1)
    check(count == 1, "session.yaml names a size: " + text)
    (session / "session.yaml").write_text(changed)
    return session


def codes(flow):
    return [one["code"] for one in json.loads(flow.rigcal("show", ROBOT, "--json").stdout)["board_remarks"]]


def is_marked_until_measured(flow, session):
    flow.rigcal("push", session)
    wait_published(flow)
    check(codes(flow) == ["unknown_serial"], "nobody measured it: %r" % codes(flow))
    check("board B-7 is not in the registry" in flow.rigcal("show", ROBOT).stdout, "show says so")
    check("not in the registry" in flow.get("/robots/stereo/revisions/1/"), "so does the report")
    check("Not in the registry" in flow.get("/boards/"), "and the page of boards")
    refused = measure(flow, 9.98, 9.99, *WHAT, exit_code=REFUSED).stderr
    check("looks like centimetres" in refused, "another unit: " + refused)
    said = measure(flow, 200, 100, *WHAT, "--next-check", datetime.date.today() + datetime.timedelta(days=365)).stdout
    check("25.000 x 25.000 mm" in said and "1 session, 1 revision and 1 robot depend on it" in said, "measured: " + said)
    flow.kill_and_restart()
    check(codes(flow) == [], "it agrees: %r" % codes(flow))


def is_corrected(flow):
    said = measure(flow, 198, 100).stdout
    check("Before, they measured 25.000 x 25.000 mm." in said and "stay as they are" in said, "corrected: " + said)
    flow.kill_and_restart()
    check(codes(flow) == ["other_size"], "the session says another size: %r" % codes(flow))
    shown = flow.rigcal("show", ROBOT).stdout
    check("is 25 mm in the session (taken as exact), and was measured to be 24.75 mm along x by Ada" in shown, "both numbers: " + shown)
    trace = json.loads(flow.rigcal("board", "trace", SERIAL, "--json").stdout)
    check(trace["totals"] == {"robots": 1, "revisions": 1, "sessions": 1}, "the trace: %r" % trace)
    check(trace["robots"][0]["robot"] == ROBOT and trace["robots"][0]["revisions"] == [1], "names them: %r" % trace)
    history = json.loads(flow.rigcal("board", "show", SERIAL, "--json").stdout)["history"]
    check(len(history) == 2 and history[1]["size"]["x_m"] == 0.025, "what was measured before is kept: %r" % history)
    check("1 board" in flow.get("/") and 'href="boards/"' in flow.get("/"), "the fleet's page leads to the boards")
    check(SERIAL in flow.get("/boards/"), "which lists it")
    audit = json.loads(flow.rigcal("audit", "--json").stdout)["rows"]
    check(audit[0]["what"].startswith("measured board B-7, ") and audit[0]["who"] == "Ada", "the audit: %r" % audit[0])
    check(flow.rigcal("audit", "verify").stdout.startswith("The audit is as it was written: "), "holds")


def main():
    with Flow() as flow:
        prints(flow)
        session = with_serial(picture_session(flow.folder / "session", ROBOT, stereo_pairs(flow.context)))
        is_marked_until_measured(flow, session)
        is_corrected(flow)
    print("boards: good")


main()
