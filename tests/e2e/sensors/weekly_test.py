"""A robot that is visited week after week: what its newest sessions do not show by themselves still counts, and people can still say
what they want of it. A session of long ago comes late; the server is killed; an edge of a merged session is retired."""
import json
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from measures.service.growth import SessionVisits  # noqa: E402

ROBOT, WEEKS, KEPT = SessionVisits.robot, 12, 8
LATE_WITHIN_S = 60


def shown(flow):
    return json.loads(flow.rigcal("show", ROBOT, "--json").stdout)


def merged_sessions(answer):
    """Of the pair that most of them saw."""
    return max((edge["figures"].get("merged_sessions", 0) for edge in answer["document"]["edges"]), default=0)


def push(flow, visits, week):
    visits.prepare(week)
    return json.loads(flow.rigcal("push", visits.session, "--json").stdout)["id"]


def add_odd_pair(visits):
    """A sensor that no other session lists: what it fails in is said nowhere else."""
    rig = (visits.folder / "rig.yaml").read_text()
    whole = visits.run("simulate", "--print-rig", "mars-mapper")
    begin = whole.index("  back:\n    {type")
    (visits.folder / "rig.yaml").write_text(rig.rstrip("\n") + "\n" + whole[begin:whole.index("  lidar_vertical:", begin)])


def late_session(flow, visits):
    add_odd_pair(visits)
    began = time.monotonic()
    late = push(flow, visits, -20)
    took_s = time.monotonic() - began
    check(took_s < LATE_WITHIN_S, "the push of a session of long ago ends, after %.0f s" % took_s)
    edges = shown(flow)["document"]["edges"]
    check(any("back" in (edge["frame_a"], edge["frame_b"]) for edge in edges), "what it says of its own sensor stands")
    check(merged_sessions(shown(flow)) == WEEKS - KEPT + 1, "it is merged: %r" % merged_sessions(shown(flow)))
    return late


def main():
    with Flow() as flow:
        visits = SessionVisits(flow.context, flow.folder)
        first = push(flow, visits, 1)
        for week in range(2, WEEKS + 1):
            push(flow, visits, week)
        check(merged_sessions(shown(flow)) == WEEKS - KEPT, "the older sessions are one: %r" % merged_sessions(shown(flow)))
        late_session(flow, visits)
        before = shown(flow)
        flow.kill_and_restart()
        check(shown(flow)["digest"] == before["digest"], "a kill changes nothing")

        retired = next(edge["id"] for edge in json.loads(flow.get("/api/v1/session?id=" + first))["edges"] if edge["state"] == "good")
        flow.rigcal("retire", retired, "--reason", "the mount was loose")
        check(merged_sessions(shown(flow)) == WEEKS - KEPT + 1, "the others are merged again")
        listed = {edge["id"]: edge for edge in json.loads(flow.rigcal("edges", ROBOT, "--json").stdout)["edges"]}
        check(listed[retired]["state"] == "failed" and "the mount was loose" in json.dumps(listed[retired]), "the list says that it is past")
        check(shown(flow)["revision"] > before["revision"], "and the calibration follows")
        print("weekly: good")


if __name__ == "__main__":
    main()
