"""Situations as people make them: does the verdict say what is the matter, of whom, what to do and whether the robot may drive? Each is
pushed to a real server; `verdict_table` has the situations, `verdict_wanted` what is asked of the answer."""
import concurrent.futures
import json
import pathlib
import sys

from ..measure import Measure, info
from ..server import ANSWERED, Server
from .verdict_rigs import Bench
from .verdict_table import SITUATIONS
from .verdict_wanted import Told, faults

REFUSED = (2, 4)
SHOWN_MAX = 150  # characters of a row; whole on stderr


def not_stored(pushed):
    """Of a push that was refused: its sentences are why and what to do."""
    said = pushed.stderr.strip().removeprefix("rigcal: ")
    return Told("refused" if pushed.returncode in REFUSED else "no verdict", said or pushed.stdout.strip(), said, codes={"push": pushed.returncode})


def before_the_verdict(text):
    """What `show` says of the robot's standing above its verdict, but for the heading."""
    return " ".join(text.split("\nverdict")[0].splitlines()[1:])


def ask(server, situation, pushed):
    """What push, show and status tell of the robot."""
    shown = server.rigcal("show", situation.robot, "--json")
    if pushed.returncode in REFUSED or shown.returncode not in ANSWERED:
        return not_stored(pushed)
    answer, text = json.loads(shown.stdout), server.rigcal("show", situation.robot).stdout
    verdict = answer["document"]["verdict"]
    is_late = verdict["level"] in ("pass", "warn") and answer["overdue"]
    why, action = (before_the_verdict(text),) * 2 if situation.wanted.in_text else (verdict["why"], verdict["what_to_do"])
    codes = {"push": pushed.returncode, "show": shown.returncode, "status": server.rigcal("status", situation.robot).returncode}
    return Told("unknown" if is_late else verdict["level"], why, action, text, codes)


def judged(bench, situation):
    """What was told, and what of it was to be told otherwise."""
    try:
        told = ask(bench.server, situation, situation.push(bench, situation.robot))
    except Exception as error:  # the other situations are judged all the same
        return Told("not taken", repr(error), ""), ["not taken: %r" % error]
    return told, faults(told, situation.wanted, bench.named.get(situation.robot, []))


def row(situation, found):
    short = "; ".join(found)
    value = "told" if not found else short if len(short) <= SHOWN_MAX else short[:SHOWN_MAX - 3] + "..."
    return Measure(situation.robot, value.replace(" ", "_"), situation.wanted.states, "SHORT" if found else "ok")


def explain(situation, told, found):
    print("%s: told %s, wanted %s\n  why: %s\n  what to do: %s\n  short: %s" % (
        situation.robot, told.state, situation.wanted.states, told.why, told.action, "\n         ".join(found)), file=sys.stderr)


def count(name, ok):
    return Measure(name, "%d_of_%d" % (ok, len(SITUATIONS)), "==%d" % len(SITUATIONS), "ok" if ok == len(SITUATIONS) else "SHORT")


def run(context):
    all_found = []
    with context.folder() as folder, Server(context, pathlib.Path(folder) / "data") as server:
        bench = Bench(context, pathlib.Path(folder), server)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for situation, (told, found) in zip(SITUATIONS, pool.map(lambda one: judged(bench, one), SITUATIONS)):
                if found:
                    explain(situation, told, found)
                all_found.append(found)
                yield row(situation, found)
    yield info("situations_ok_but_for_whether_to_drive", "%d_of_%d" % (
        sum(all(one.startswith("drive: ") for one in found) for found in all_found), len(SITUATIONS)))
    yield count("situations_ok", all_found.count([]))
