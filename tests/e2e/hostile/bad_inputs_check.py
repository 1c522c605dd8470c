"""Runs the table of bad inputs against one server and says of each case what was wrong with the answer."""
import json
import pathlib
import re
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import bad_inputs  # noqa: E402
from bad_session import CAPTURES, YAML  # noqa: E402
from flow import ANSWERED  # noqa: E402


class Checker:
    """`server`: a running measures.server.Server; `address`: where its HTTP is; `folder`: for what is made."""

    def __init__(self, server, address, folder):
        self.server, self.address, self.folder = server, address, folder

    def get(self, verb, **parameters):
        """The document, or None if there is none of that name."""
        try:
            with urllib.request.urlopen(self.address + "/api/v1/" + verb + "?" + urllib.parse.urlencode(parameters), timeout=20) as reply:
                return json.loads(reply.read())
        except urllib.error.HTTPError as error:
            if error.code in (400, 404):
                return None
            raise

    def healthy(self):
        with urllib.request.urlopen(self.address + "/readyz", timeout=20) as reply:
            return reply.status == 200

    def run(self, case, index):
        """Empty: the answer is as the table says. Otherwise what is wrong with it."""
        robot = "bad-%03d" % index
        if case.kind == "wire":
            problem = self.wire(case)
        else:
            place = case.make(self.folder / robot, robot)
            problem = self.refused(case, place, robot) if case.kind in ("push", "edges") else self.stored(case, place, robot)
        if not self.healthy():
            return "the server is not well; " + problem
        return problem

    def refused(self, case, place, robot):
        command = ["push", place, "--new-robot"] if case.kind == "push" else ["push-edges", place, "--robot", robot]
        done = self.server.rigcal(*command, "--json", "--timeout-total", "20", timeout=60)
        said = done.stdout.strip() + " / " + done.stderr.strip()[-600:]
        if done.returncode != 4:
            return "exit code %d instead of 4: %s" % (done.returncode, said)
        try:
            error = json.loads(done.stdout)["error"]
        except (ValueError, KeyError):
            return "no error document: " + said
        if not error["cure"] or not error["code"]:
            return "no cure: " + said
        if not done.stderr.startswith("rigcal: " + error["what"]):
            return "another sentence for people: " + said
        if not re.match(case.expected, error["what"], re.DOTALL):
            return "another sentence: " + said
        if self.get("sessions", robot=robot) or self.get("edges", robot=robot):
            return "something was stored"
        return ""

    def stored(self, case, place, robot):
        done = self.server.rigcal("push", place, "--new-robot", "--timeout-total", "30", timeout=60)
        if done.returncode not in ANSWERED:
            return "exit code %d: %s" % (done.returncode, done.stderr.strip()[-600:])
        edges = self.get("edges", robot=robot)["edges"]
        if not edges or (case.kind == "stored" and edges[0]["state"] != "failed"):
            return "no failed edge: %r" % edges
        if case.kind == "noted" and edges[0]["state"] != "good":
            return "the other captures do not calibrate: %r" % edges[0]["diagnoses"]
        said = [diagnosis["what"] for diagnosis in edges[0]["diagnoses"] if diagnosis["cure"]]
        return "" if any(re.match(case.expected, what, re.DOTALL) for what in said) else "other diagnoses: %r" % said

    def wire(self, case):
        done = subprocess.run([str(self.server.context.bin / "hostile_client"), case.name], capture_output=True, text=True, errors="replace",
                              timeout=60, env=self.server.environment())
        if done.returncode != 0:
            return "exit code %d: %s" % (done.returncode, done.stderr.strip()[-400:])
        what, _, cure = done.stdout.partition("\n")
        if not re.match(case.expected, what):
            return "another sentence: " + done.stdout
        if re.match("refused|error", what) and not cure.strip():
            return "no cure: " + done.stdout
        return ""

    def good_session_calibrates(self):
        """After all of it. Empty, or what is wrong."""
        place = bad_inputs.write(self.folder / "good", YAML.replace("ROBOT", "good"), bad_inputs.GOOD)
        done = self.server.rigcal("push", place, "--new-robot", timeout=60)
        if done.returncode not in ANSWERED:
            return "exit code %d: %s" % (done.returncode, done.stderr)
        edge = self.get("edges", robot="good")["edges"][0]
        if edge["state"] != "good" or edge["figures"]["captures_used"] != CAPTURES:
            return "%r" % edge
        return "" if abs(edge["T_a_b"]["p_m"][0] - 0.04) < 0.002 else "T_a_b: %r" % edge["T_a_b"]


def run_all(checker, tell=lambda line: None, only=""):
    """[(case, problem)], problem empty where all is as expected."""
    outcomes = []
    for index, case in enumerate(bad_inputs.CASES):
        if only and not re.search(only, case.kind + " " + case.name):
            continue
        try:
            problem = checker.run(case, index)
        except (OSError, subprocess.SubprocessError, ValueError) as error:
            problem = repr(error)
        outcomes.append((case, problem))
        if problem:
            tell("%s, %s: %s" % (case.kind, case.name, problem))
    return outcomes
