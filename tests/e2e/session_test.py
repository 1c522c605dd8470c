"""Real picture pairs: pushed while client and server are killed; the end is that of an undisturbed run."""
import json
import subprocess

from flow import Flow, check, stereo_pairs
from measures.sessions import picture_session


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

        edge = shown["document"]["edges"][0]
        baseline_m = sum(value * value for value in edge["T_a_b"]["p_m"]) ** 0.5
        check(abs(baseline_m - 0.08318) < 0.0003, "baseline %.6f m" % baseline_m)
        again = json.loads(flow.rigcal("push", session, "--json").stdout)
        check(again["held_before"] == again["total"], "pushing again sends nothing")
        sessions = json.loads(flow.rigcal("sessions", "stereo", "--json").stdout)["sessions"]
        check(len(sessions) == 1 and sessions[0]["state"] == "closed", "one closed session: %r" % sessions)
    print("session: good")


main()
