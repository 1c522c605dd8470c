"""Completion: the scripts in their shells, with a program that only says what it is told, and with a server's own names."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edge_case import edge  # noqa: E402
from flow import ROOT, Flow, check  # noqa: E402

SCRIPTS = {"bash": "rigcal.bash", "zsh": "_rigcal", "fish": "rigcal.fish"}
# Notes what it was asked, one argument a line, and answers what the file beside it holds.
FAKE = r"""#!/bin/sh
printf '%s\n' "$@" >"$(dirname "$0")/asked"
cat "$(dirname "$0")/answer"
"""
# Completes the line of its arguments, as bash does when the key is pressed. Outside of that, compopt would not know of what.
PRESS = r"""source "$1"; shift
compopt() { echo "option $*"; }
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_rigcal "$1" "${!#}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf 'reply %s\n' "${COMPREPLY[@]}"
complete -p rigcal
"""


def script(shell):
    return ROOT / "client" / "completion" / SCRIPTS[shell]


def press(line, environment):
    done = subprocess.run(["bash", "-c", PRESS, "bash", str(script("bash")), *line], env=environment, capture_output=True, text=True, timeout=60)
    check(done.returncode == 0 and not done.stderr, "%r: %d, %s" % (line, done.returncode, done.stderr))
    lines = done.stdout.splitlines()
    check(lines[-1] == "complete -F _rigcal rigcal", "it is registered: " + done.stdout)
    return [text for text in lines[:-1] if text != "reply "]


def with_a_fake_program(folder):
    folder.mkdir()
    program = folder / "rigcal"
    program.write_text(FAKE)
    program.chmod(0o755)
    environment = {**os.environ, "PATH": "%s:%s" % (folder, os.environ["PATH"])}
    cases = [(["rigcal", "pu"], "push\tSend\npush-edges\tSend\n", ["reply push", "reply push-edges"]),
             (["rigcal", "show", ""], "mapper-01\nmapper-02\n", ["reply mapper-01", "reply mapper-02"]),
             (["rigcal", "push-edges", "--robot", "="], "mapper-01\n", ["reply mapper-01"]),
             (["rigcal", "push", "vis"], ":files\n", ["option -o default"]),
             (["rigcal", "push-edges", "e"], ":files\n", ["option -o default"]),
             (["rigcal", "show", "x"], "", [])]
    for line, answer, wanted in cases:
        (folder / "answer").write_text(answer)
        told = press(line, environment)
        check(told == wanted, "%r: %r" % (line, told))
        asked = (folder / "asked").read_text().split("\n")[:-1]
        check(asked == ["complete-words", "--", *line[1:]], "%r asks %r" % (line, asked))
    program.unlink()
    check(press(["rigcal", "sh"], environment) == [] or shutil.which("rigcal"), "without the program it is silent")


def scripts_are_read(flow):
    readers = {"bash": ["bash", "-n"], "zsh": ["zsh", "-n"], "fish": ["fish", "--no-execute"]}
    for shell, command in readers.items():
        printed = flow.rigcal("completion", shell).stdout
        check(printed == script(shell).read_text(), "the script of %s is the file" % shell)
        if shutil.which(command[0]):
            done = subprocess.run([*command, str(script(shell))], capture_output=True, text=True, timeout=60)
            check(done.returncode == 0, "%s: %s" % (shell, done.stderr))


def with_a_server(flow):
    path = flow.folder / "edges.json"
    path.write_text(json.dumps({"format": 1, "edges": [edge("front_left", "front_right", 1.0), edge("front_left", "top", 2.0)]}))
    flow.rigcal("push-edges", path, "--robot", "mapper-01")
    environment = {**flow.server.environment(), "PATH": "%s:%s" % (flow.context.bin, os.environ["PATH"])}
    for line, wanted in ((["show", "map"], ["reply mapper-01"]), (["lookup", "mapper-01", ""], ["reply front_left", "reply front_right", "reply top"]),
                         (["lookup", "mapper-01", "top", "front_l"], ["reply front_left"]), (["edges", "nobody"], []),
                         (["retire", "--robot", "mapper-01", "to"], ["reply top"]), (["retire", "to"], []),
                         (["export", "mapper-01", "--root", "front_r"], ["reply front_right"]),
                         (["check", "visit/", "--js"], ["reply --json"]), (["simulate", "--captured"], ["reply --captured-at"]),
                         (["check", ""], ["option -o dirnames"]), (["backup", ""], ["option -o dirnames"]),
                         (["migrate-store", "/srv/a", ""], ["option -o dirnames"]), (["migrate-store", "--da"], ["reply --data"])):
        told = press(["rigcal", "--timeout", "20", *line], environment)
        check(told == wanted, "%r: %r" % (line, told))
    for verb in re.findall(r'VerbElsewhere k\w+Verb\{\s*"([^"]+)"', (ROOT / "client/verbs.h").read_text()):
        told = press(["rigcal", verb, "--"], environment)
        check("reply --help" in told, "the program that has %s completes it: %r" % (verb, told))


def main():
    with Flow() as flow:
        scripts_are_read(flow)
        with_a_fake_program(flow.folder / "fake")
        with_a_server(flow)
    print("completion: good")


main()
