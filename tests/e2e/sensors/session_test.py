"""Real picture pairs: pushed while client and server are killed; the end is that of an undisturbed run."""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, stereo_pairs  # noqa: E402
from measures.sessions import picture_session  # noqa: E402


def lenses_leave(flow):
    """The intrinsics in the files of other programs are those that the server tells."""
    told = json.loads(flow.get("/api/v1/sensors?robot=stereo"))["sensors"]
    check([one["kind"] for one in told] == ["camera", "camera"] and all(one["camera"]["views"] == [] for one in told), "sensors: %r" % told)
    [session] = json.loads(flow.rigcal("sessions", "stereo", "--json").stdout)["sessions"]
    check(all(one["refined_in"] == session["session"] for one in told), "lenses of the refinement that the poses are of: %r" % told)
    folder = flow.folder / "camera_info"
    flow.rigcal("export", "stereo", "--format", "camera_info", "--out", folder, "--even-if-not-approved")
    for one in told:
        fx_px, fy_px, cx_px, cy_px = one["camera"]["intrinsics"]["f_c_px"]
        text = (folder / (one["id"] + ".yaml")).read_text()
        check("data: [%r, 0.0, %r, 0.0, %r, %r, 0.0, 0.0, 1.0]" % (fx_px, cx_px, fy_px, cy_px) in text, "K of %s: %s" % (one["id"], text))


def main():
    with Flow() as quiet, Flow() as flow:
        session = picture_session(quiet.folder / "session", "stereo", stereo_pairs(quiet.context))
        quiet.rigcal("push", session)
        wanted = json.loads(quiet.rigcal("show", "stereo", "--json").stdout)

        client = subprocess.Popen(flow.server.client("push", session), stderr=subprocess.PIPE, text=True, env=flow.server.environment())
        client.stderr.readline()  # the first thing it says: killed wherever it then is
        client.kill()
        client.wait()
        client.stderr.close()
        flow.kill_and_restart()
        flow.rigcal("push", session)
        shown = json.loads(flow.rigcal("show", "stereo", "--json").stdout)
        check(shown["document"] == wanted["document"], "killed and undisturbed runs end in the same revision")

        lenses_leave(flow)
        edge = shown["document"]["edges"][0]
        baseline_m = sum(value * value for value in edge["T_a_b"]["p_m"]) ** 0.5
        check(abs(baseline_m - 0.08318) < 0.0003, "baseline %.6f m" % baseline_m)
        again = json.loads(flow.rigcal("push", session, "--json").stdout)
        check(again["held_before"] == again["total"], "pushing again sends nothing")
        sessions = json.loads(flow.rigcal("sessions", "stereo", "--json").stdout)["sessions"]
        check(len(sessions) == 1 and sessions[0]["state"] == "closed", "one closed session: %r" % sessions)
    print("session: good")


main()
