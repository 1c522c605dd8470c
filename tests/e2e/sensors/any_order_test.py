"""The same nine visits, pushed week by week, or all at once and the newest first: poses and covariances are the same but for rounding
(sessions of another robot have other ids, and are summed in another order).
So they are where later visits came with these, and were retired: what does not count takes no place of what does."""
import datetime
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check, wait_published  # noqa: E402
from front_rig import front_rig  # noqa: E402

VISITS, RETIRED = 9, 2  # more than eight
SAME = 1e-9
SENSORS = ("front_left", "front_right", "front_top")


def visit(flow, robot, week):
    """Another robot's folder of the same visit has the same pictures."""
    folder = flow.folder / ("%s-%02d" % (robot, week))
    day = datetime.date(2026, 1, 1) + datetime.timedelta(weeks=week)
    flow.rigcal("simulate", front_rig(flow, robot, folder.name), "--out", folder, "--seed", 50 + week, "--captures", 8, "--scale", 0.2,
                "--captured-at", day, "--visit-scatter", "0.5,0.01")
    header = folder / "session.yaml"
    lines = header.read_text().splitlines(keepends=True)
    header.write_text("".join(line for line in lines if not line.startswith("rig_model:")))  # robots of a model tell each other's scatter
    return folder


def push(flow, robot, weeks, *words):
    ids = []
    for week in weeks:
        done = flow.server.rigcal("push", visit(flow, robot, week), "--new-robot", "--json", *words)
        check(done.returncode not in (2, 3, 4), "it is taken: %s%s" % (done.stdout, done.stderr))
        ids.append(json.loads(done.stdout)["id"])
    return ids


def poses(flow, robot):
    """Of the newest revision, whoever has approved it."""
    wait_published(flow)
    number = json.loads(flow.rigcal("history", robot, "--limit", 1, "--json").stdout)["revisions"][0]["revision"]
    asked = [json.loads(flow.rigcal("lookup", robot, a, b, "--revision", number, "--json").stdout) for a in SENSORS for b in SENSORS if a < b]
    return [(told["T_a_b"], told["covariance"]) for told in asked]


def check_same(told, wanted, what):
    for (T, C), (T_wanted, C_wanted) in zip(told, wanted):
        sigmas = [C_wanted[k][k] ** 0.5 for k in range(6)]
        off = max(abs(p - q) / sigma for p, q, sigma in zip(T["p_m"], T_wanted["p_m"], sigmas))
        other = max(abs(C[i][j] - C_wanted[i][j]) / (sigmas[i] * sigmas[j]) for i in range(6) for j in range(6))
        check(off < SAME and other < SAME, "%s: %.3g sigmas off, covariance by %.3g" % (what, off, other))


def main():
    with Flow() as flow:
        push(flow, "weekly", range(VISITS))
        weekly = poses(flow, "weekly")
        push(flow, "backlog", reversed(range(VISITS)), "--no-wait")
        check_same(poses(flow, "backlog"), weekly, "all at once")
        taken_out = push(flow, "thinned", range(VISITS + RETIRED), "--no-wait")[VISITS:]
        wait_published(flow)
        for session in taken_out:
            flow.rigcal("retire", session, "--robot", "thinned", "--reason", "another board", "--no-wait")
        check_same(poses(flow, "thinned"), weekly, "of what counts")
    print("any_order: good")


main()
