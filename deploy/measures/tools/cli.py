"""The command line as people and scripts meet it: slips of the finger, the key that completes, JSON and exit codes of every verb."""
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import urllib.request

from ..measure import at_least, equal, info
from ..server import Server

E2E = pathlib.Path(__file__).resolve().parents[3] / "tests" / "e2e"
LETTERS = "abcdefghijklmnopqrstuvwxyz"
SLIPS_PER_NAME, SEED = 5, 21
PRESS = r"""source "$1"; shift
compopt() { :; }
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_rigcal "$1" "${!#}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf '%s\n' "${COMPREPLY[@]}"
"""


def rigcal(context, *arguments, environment=None):
    return subprocess.run([str(context.bin / "rigcal"), *map(str, arguments)], capture_output=True, text=True, timeout=120, env=environment)


def verbs_of(context):
    listed = rigcal(context, "--help").stdout.split("Subcommands:\n", 1)[1].split("\n\n", 1)[0]
    return re.findall(r"(?m)^  ([a-z][a-z0-9-]*) ", listed)


def slip(name, draw):
    """A letter left out, doubled, exchanged with its neighbour, or hit wrong."""
    kind, at = draw.randrange(4), draw.randrange(len(name) - 1)
    if kind == 0:
        return name[:at] + name[at + 1:]
    if kind == 1:
        return name[:at] + name[at] + name[at:]
    if kind == 2:
        return name[:at] + name[at + 1] + name[at] + name[at + 2:]
    return name[:at] + draw.choice(LETTERS) + name[at + 1:]


def slips_of(names):
    """(slip, name), none of which is a name; the same ones on every run."""
    draw = random.Random(SEED)
    drawn = [(slip(name, draw), name) for name in names if len(name) > 3 for _ in range(SLIPS_PER_NAME)]
    return [(wrong, name) for wrong, name in drawn if wrong not in names]


def share(rows):
    """% of the flags, and what was wrong."""
    rows = list(rows)
    return 100.0 * sum(good for good, _ in rows) / len(rows), [what for good, what in rows if not good]


def proposes(done, name):
    return done.returncode == 2 and re.search(r"did you mean [^?]*\b%s\b" % re.escape(name), done.stderr) is not None


def words(context):
    verbs = verbs_of(context)
    yield info("verbs", len(verbs))
    told, wrong = share((proposes(rigcal(context, typed), name), typed + " for " + name) for typed, name in slips_of(verbs))
    yield at_least("slips_in_verbs_whose_verb_is_proposed", told, 95, "%", wrong)
    helps = {verb: rigcal(context, verb, "--help") for verb in verbs}
    bare = [verb for verb, done in helps.items() if done.returncode != 0 or "rigcal " + verb not in done.stdout.split("Example", 1)[-1]]
    yield equal("verbs_whose_help_has_no_example", len(bare), 0, bare)
    unknown = [verb for verb in verbs if rigcal(context, verb, "--no-such-option").returncode != 2]
    yield equal("verbs_that_take_an_unknown_option", len(unknown), 0, unknown)


def pressed(context, line, environment):
    script = context.root / "client" / "completion" / "rigcal.bash"
    with_path = {**environment, "PATH": "%s:%s" % (context.bin, environment["PATH"])}
    done = subprocess.run(["bash", "-c", PRESS, "bash", str(script), *line], env=with_path, capture_output=True, text=True, timeout=60)
    return done.stdout.split()


def pushed_edges(server, folder, moved_m=0.0):
    """A robot of three sensors in a loop; the third edge does not close it by `moved_m`."""
    from edge_case import edge
    path = folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("front_left", "front_right", 1.0), edge("front_left", "top", 2.0), edge("front_right", "top", 1.0 + moved_m)]}))
    return path


def completion(context, server):
    environment = server.environment()
    verbs = verbs_of(context)
    told, wrong = share((verb in pressed(context, ["rigcal", verb[:-1]], environment), verb) for verb in verbs)
    yield equal("verbs_that_the_key_completes", told, 100.0, wrong)
    names = [(["show", "mapp"], "mapper-01"), (["lookup", "mapper-01", "fr"], "front_left"), (["edges", "m"], "mapper-01"),
             (["history", "m"], "mapper-01"), (["lookup", "mapper-01", "front_left", "t"], "top"), (["retire", "--robot", "m"], "mapper-01"),
             (["retire", "--robot", "mapper-01", "front_l"], "front_left")]
    told, wrong = share((name in pressed(context, ["rigcal", *line], environment), " ".join(line)) for line, name in names)
    yield equal("names_of_robots_and_sensors_that_it_completes", told, 100.0, wrong)


def slips_in_names(context, server):
    robots = [(["show", typed], name) for typed, name in slips_of(["mapper-01"])]
    sensors = [(["lookup", "mapper-01", typed, "top"], name) for typed, name in slips_of(["front_left", "front_right"])]

    def is_proposed(arguments, name):
        done = server.rigcal(*arguments)
        return done.returncode in (2, 4) and "did you mean" in done.stderr and name in done.stderr
    told, wrong = share((is_proposed(arguments, name), " ".join(arguments)) for arguments, name in robots + sensors)
    yield at_least("slips_in_robots_and_sensors_that_are_proposed", told, 95, "%", wrong)


ASKING = (["robots"], ["sessions"], ["edges", "mapper-01"], ["show", "mapper-01"], ["history", "mapper-01"], ["lookup", "mapper-01", "front_left", "top"],
          ["status"], ["due"], ["audit"], ["audit", "verify"], ["model", "list"], ["policy", "show"], ["doctor"], ["board", "list"], ["webhooks"],
          ["report", "mapper-01"], ["sessions", "mapper-01"])


def is_json(text):
    try:
        json.loads(text)
        return True
    except ValueError:
        return False


def documents(context, server):
    told, wrong = share((is_json(server.rigcal(*arguments, "--json").stdout), " ".join(arguments)) for arguments in ASKING)
    yield equal("questions_answered_with_one_json_document", told, 100.0, wrong)
    refused = (["show", "nobody"], ["lookup", "mapper-01", "front_left", "nobody"], ["push", "no-such-folder"], ["report", "nobody"])
    told, wrong = share((server.rigcal(*arguments, "--json").returncode in (2, 4), " ".join(arguments)) for arguments in refused)
    yield equal("refusals_whose_exit_code_says_so", told, 100.0, wrong)


def codes(context, server, folder):
    """Exit codes are what scripts act on: each, brought about once."""
    alone = {**server.environment(), "RIGCAL_DDS_TAG": server.tag + "-nobody"}
    cases = {"good_or_doubtful": (server.rigcal("push-edges", pushed_edges(server, folder), "--robot", "mapper-01").returncode, (0, 5, 6)),
             "fail": (server.rigcal("push-edges", pushed_edges(server, folder, 0.5), "--robot", "mapper-02").returncode, (1,)),
             "usage": (rigcal(context, "show").returncode, (2,)),
             "no_server": (rigcal(context, "--timeout", "1", "robots", environment=alone).returncode, (3,)),
             "refused": (server.rigcal("show", "nobody-at-all").returncode, (4,)),
             "worst_of_several": (server.rigcal("status", "--json").returncode, (1,))}
    wrong = ["%s: exit %d, not %s" % (name, code, wanted) for name, (code, wanted) in cases.items() if code not in wanted]
    yield equal("exit_codes_wrong_of_%d" % len(cases), len(wrong), 0, wrong)


def session(context, server, folder):
    """A real push: what is said while it runs, and where its page is."""
    simulated = folder / "visit"
    context.run_json("rigcal", "simulate", "mars-mapper", "--captures", 8, "--scale", 0.4, "--out", simulated, "--json")
    done = server.rigcal("push", simulated, timeout=600)
    said = done.stdout + done.stderr
    counted = re.findall(r"(\d+) of (\d+)", said)
    yield equal("push_tells_how_far_it_is", bool(counted), True, [] if counted else [said[-300:]])
    addresses = re.findall(r"https?://\S+", said)
    opens = bool(addresses) and urllib.request.urlopen(addresses[-1].rstrip(".,"), timeout=20).status == 200
    yield equal("push_prints_a_page_that_opens", opens, True, [] if opens else [said[-300:]])
    table = next(simulated.rglob("poses.csv"))
    head, *rows = table.read_text().splitlines()
    columns = head.split(",")
    lengths = [i for i, name in enumerate(columns) if name in ("x_m", "y_m", "z_m")]
    table.write_text("\n".join([head] + [",".join(repr(1e3 * float(cell)) if i in lengths else cell for i, cell in enumerate(row.split(","))) for row in rows]) + "\n")
    done = server.rigcal("push", simulated, "--new-robot", timeout=600)
    named = "millimet" in done.stdout + done.stderr + server.rigcal("show", "mars-mapper").stdout
    yield equal("poses_in_millimetres_are_named", named, True, [] if named else [(done.stdout + done.stderr)[-300:]])


def run(context):
    sys.path[:0] = [str(E2E)]
    yield from words(context)
    with context.folder() as name:
        folder = pathlib.Path(name)
        server = Server(context, folder / "store").start()
        try:
            server.wait_address()
            yield from codes(context, server, folder)
            for part in (completion, slips_in_names, documents):
                yield from part(context, server)
            yield from session(context, server, folder)
        finally:
            server.stop()
