"""Pushes with identities (DDS Security, everything encrypted) against the same without, side by side; and how long a question takes."""
import json
import os
import pathlib
import statistics
import subprocess
import time

from ..measure import at_least, equal, info
from ..server import Server
from ..sessions import noise_session

PAYLOAD_BYTES = 3_000_000
COUNT = 100
ROUNDS = 3
QUESTIONS = 7


class WithIdentity:
    """Servers and clients of one authority; an operator pushes."""
    def __init__(self, context, folder):
        self.folder = folder
        for words in (["init"], ["new", "operator", "ada"]):
            subprocess.run([str(context.bin / "rigcal"), "identity", *words, "--authority", str(folder)], check=True, capture_output=True, timeout=60)

    def server(self):
        return ("--dds-identity", str(self.folder / "server"))

    def client(self):
        return ("--dds-identity", str(self.folder / "operators" / "ada"))


class Without:
    def server(self):
        return ()

    client = server


def rate_of(context, folder, session, side):
    """bytes/s of a durable push from the first receipt to the closed session, into a new store."""
    server = Server(context, folder)
    try:
        server.start(*side.server()).wait_ready()
        done = server.rigcal("push", session, "--no-wait", "--json", *side.client())
        if done.returncode != 0:
            raise RuntimeError("push: exit %d: %s" % (done.returncode, done.stderr[-300:]))
        document = json.loads(done.stdout)
        return (document["total"] - document["held_before"]) / (document["transfer_ns"] * 1e-9), question_s(server, side)
    finally:
        server.stop()


def question_s(server, side):
    """The whole command `rigcal robots`."""
    taken = []
    for _ in range(QUESTIONS):
        start = time.perf_counter()
        if server.rigcal("robots", *side.client()).returncode != 0:
            raise RuntimeError("rigcal robots failed")
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def run(context):
    os.environ.pop("RIGCAL_DDS_IDENTITY", None)
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        session = noise_session(folder / "session", "big", PAYLOAD_BYTES, COUNT, seed=1)
        sides = {"off": Without(), "on": WithIdentity(context, folder / "fleet")}
        rates, questions = {name: [] for name in sides}, {name: [] for name in sides}
        for idx in range(ROUNDS):
            for name, side in sides.items():
                rate, question = rate_of(context, folder / ("%s-%d" % (name, idx)), session, side)
                rates[name].append(rate)
                questions[name].append(question)
        for name in sides:
            yield info("push_identities_%s" % name, statistics.median(rates[name]) / 1e6, "MB/s")
            yield info("question_identities_%s" % name, statistics.median(questions[name]), "s")
        yield at_least("push_share_with_identities", statistics.median(rates["on"]) / statistics.median(rates["off"]), 0.7)
        yield from stranger_is_refused(context, folder, sides["on"])


def stranger_is_refused(context, folder, side):
    server = Server(context, folder / "strangers")
    try:
        server.start(*side.server()).wait_ready()
        yield equal("strangers_exit_code", server.rigcal("robots", "--timeout", "3").returncode, 3)
        yield equal("operators_exit_code", server.rigcal("robots", *side.client()).returncode, 0)
    finally:
        server.stop()
