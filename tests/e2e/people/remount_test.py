"""Three cameras before one board, one of them moved by 8 mm between two visits: named with both visits, until the second visit says that it
was remounted; the same in whatever order the visits come, and with a server that was killed in between."""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from front_rig import front_rig  # noqa: E402

MOVED, OTHERS = "front_right", ("front_left", "front_top")


def simulate(flow, name, seed, captured_at, moved_m):
    flow.rigcal("simulate", front_rig(flow, "moved", name, moved_m), "--out", flow.folder / name, "--seed", seed, "--captures", 20, "--scale", 0.3,
                "--captured-at", captured_at)
    return flow.folder / name


def document(flow, exit_code=None):
    return json.loads(flow.rigcal("show", "moved", "--json", exit_code=exit_code).stdout)["document"]


def newest(flow):
    return json.loads(flow.rigcal("show", "moved", "--json").stdout)["revision"]


def with_code(shown, code):
    """Pairs of the edges that are out of the solution for this reason, by session."""
    return sorted((edge["session"][:12], edge["frame_a"], edge["frame_b"]) for edge in shown["edges"]
                  if edge["state"] == "failed" and [one["code"] for one in edge["diagnoses"]] == [code])


def good(shown):
    return sorted((edge["session"][:12], edge["frame_a"], edge["frame_b"]) for edge in shown["edges"] if edge["state"] == "good")


def pairs(session, with_moved=True):
    names = ("front_left", "front_right", "front_top")
    return sorted((session[:12], a, b) for i, a in enumerate(names) for b in names[i + 1:] if with_moved or MOVED not in (a, b))


def pushed(flow, *arguments, exit_code=None):
    return json.loads(flow.rigcal("push", *arguments, "--json", exit_code=exit_code).stdout)["id"]


def check_moved_between(flow):
    verdict = document(flow, exit_code=1)["verdict"]
    check("ront_right was moved between the sessions of 2026-01-31 and 2026-02-03, by " in verdict["why"], "named: %r" % verdict)
    check("--remounted " + MOVED in verdict["what_to_do"], "what to do: %r" % verdict)


def check_settled(flow, first, second, truth):
    shown = document(flow)
    check(shown["verdict"]["level"] == "pass", "no contradiction is left: %r" % shown["verdict"])
    check(good(shown) == sorted(pairs(second) + pairs(first, with_moved=False)), "what counts: %r" % good(shown))
    past = [pair for pair in pairs(first) if MOVED in pair]
    check(with_code(shown, "remounted") == past, "what is past: %r" % with_code(shown, "remounted"))
    text = flow.rigcal("show", "moved").stdout
    check("front_left - front_right, front_right - front_top: PAST\n  sensor %s was remounted after this was measured, says session %s" %
          (MOVED, second[:12]) in text, "show says so: " + text)
    check("FAILED" not in text, "nothing has failed: " + text)
    compared = json.loads(flow.rigcal("compare", "moved", "--poses", truth, "--json").stdout)["sensors"]
    for sensor in compared:
        off_m = max(abs(e) for e in sensor["e"][:3])
        check(off_m < 0.004, "%s is where the second visit has it, not 8 mm beside: %r" % (sensor["id"], sensor))
    return shown


def main():
    with Flow() as flow:
        visits = [simulate(flow, "first", 1, "2026-01-31", 0.0), simulate(flow, "second", 2, "2026-02-03", 0.008)]
        first = pushed(flow, visits[0])
        plain = pushed(flow, visits[1], exit_code=1)
        check_moved_between(flow)
        second = pushed(flow, visits[1], "--remounted", MOVED)
        shown = check_settled(flow, first, second, visits[1] / "truth.yaml")
        check(with_code(shown, "superseded") == pairs(plain), "the push before is superseded: %r" % with_code(shown, "superseded"))
        number = newest(flow)
        page = flow.get("/robots/moved/revisions/%d/" % number)
        check(page.count(">past</span>") >= 2 and ">failed</span>" not in page, "the report calls them past")
        check(">past</span>" in flow.get("/robots/moved/sessions/%s/" % first), "so does the page of the first visit")
        check(pushed(flow, visits[1], "--remounted", "%s,%s" % (MOVED, MOVED)) == second, "named twice it is the same session")
        check(newest(flow) == number, "and nothing new")
        check_again(flow.folder, visits, first, second)
    print("remount: good")


def check_again(folder, visits, first, second):
    """The later visit first, the server killed at once; and in order: the same bytes."""
    documents = []
    for order, arguments in (((1, 0), ("--no-wait",)), ((0, 1), ())):
        with Flow() as flow:
            for k in order:
                flow.rigcal("push", visits[k], *(("--remounted", MOVED) if k == 1 else ()), *arguments)
                if arguments:
                    flow.kill_and_restart()
                    arguments = ()
            documents.append(json.dumps(check_settled(flow, first, second, visits[1] / "truth.yaml")))
    check(documents[0] == documents[1], "the order of arrival does not show")


main()
