"""Many robots in one store: what one robot's question costs must not depend on how many others there are."""
import json
import pathlib
import statistics
import subprocess
import threading
import time
import urllib.request

from ..measure import at_least, at_most, info
from ..server import ANSWERED, Server
from .growth import Rig
from .pushing import Pushing


def seconds(url):
    began = time.perf_counter()
    with urllib.request.urlopen(url, timeout=60) as reply:
        reply.read()
    return time.perf_counter() - began


class Pushes(Pushing):
    """One robot's weekly visits, one after the other without a pause, until it is left."""

    def __init__(self, server, folder):
        super().__init__(server)
        self.path, self.rig, self.first = folder / "busy.json", Rig(), threading.Event()

    def push_next(self):
        self.path.write_text(json.dumps(self.rig.week(self.pushed + 1)))
        refused = self.refusal_of("push-edges", self.path, "--robot", "busy", "--no-wait")
        self.pushed += 0 if refused else 1
        self.first.set()
        return refused

    def __enter__(self):
        self.began = time.monotonic()
        return super().__enter__()

    def edges_per_s(self):
        return 59 * self.pushed / (time.monotonic() - self.began)


class Load:
    """Edges of many robots from eight clients at once, at a given rate, until its time is over."""
    RATE, ROBOTS, SECONDS = 5300, 64, 25

    def __init__(self, context, server, folder):
        path = folder / "load.json"
        path.write_text(json.dumps(Rig().week(1)))
        self.process = subprocess.Popen([str(context.bin / "edge_load"), "--tag", server.tag, "--file", str(path), "--robots", str(self.ROBOTS),
                                         "--edges-per-s", str(self.RATE), "--seconds", str(self.SECONDS)],
                                        stdout=subprocess.PIPE, text=True, env=server.environment())

    def finish(self):
        """Edges per second that were stored."""
        said = self.process.communicate()[0]
        if self.process.returncode != 0:
            raise RuntimeError("edge_load failed")
        return json.loads(said)["edges_per_s"]


def robots_waiting(server):
    """How many robots have edges that are in no revision."""
    with urllib.request.urlopen(server.address + "/metrics", timeout=60) as reply:
        lines = reply.read().decode().splitlines()
    return next(float(line.split()[-1]) for line in lines if line.startswith("rigcal_robots_waiting "))


def of_many_robots(context, robots=1000, clients=8):
    """Each robot brings its edges once, all of them at the same time: until they are durable, and until all robots are revised."""
    with context.folder() as name:
        folder = pathlib.Path(name)
        path = folder / "load.json"
        path.write_text(json.dumps(Rig().week(1)))
        with Server(context, folder / "data") as server:
            began = time.monotonic()
            load = context.run_json("edge_load", "--tag", server.tag, "--file", path, "--robots", robots, "--clients", clients, "--batches", robots,
                                    "--edges-per-s", 1e6, "--seconds", 600, env=server.environment(), timeout=900)
            yield at_least("edges_durable_of_%d_robots_from_%d_clients" % (robots, clients), load["edges_per_s"], 5000.0, "/s")
            while robots_waiting(server) > 0 and time.monotonic() - began < 600:
                time.sleep(0.5)
            yield at_most("all_%d_robots_revised" % robots, time.monotonic() - began, 60.0, "s")
            yield at_most("rss_with_%d_robots" % robots, server.rss_mib(), 1024.0, "MiB")


def asked(context, server, count):
    """Figures in ms of one robot's questions and of the fleet's page."""
    address = server.address
    polls = sorted(seconds(address + "/api/v1/live?robot=robot-500") for _ in range(count))
    robot_pages = [seconds(address + "/robots/robot-500/") for _ in range(10)]
    fleet_pages = [seconds(address + "/") for _ in range(3)]
    lookups = context.run_json("query_bench", "--tag", server.tag, "--robot", "asked", "--a", "s00", "--b", "s11", "--count", count, env=server.environment())
    return {"poll_p99": (1e3 * polls[int(0.99 * (count - 1))], 5.0), "robot_page": (1e3 * statistics.median(robot_pages), 50.0),
            "fleet_page": (1e3 * statistics.median(fleet_pages), 500.0), "lookup_p99": (lookups["p99_ms"], 20.0)}


def fill(context, data, robots, visits):
    subprocess.run([str(context.bin / "page_store"), "fleet", str(data), str(robots), str(visits)], check=True, stdout=subprocess.DEVNULL)


def p99_ms(url, count):
    return 1e3 * sorted(seconds(url) for _ in range(count))[int(0.99 * (count - 1))]


def of_one_visit(context, robots):
    """Very many robots that came once: a start, pages of the list of them, and what its open page asks every second."""
    with context.folder() as name:
        data = pathlib.Path(name) / "data"
        fill(context, data, robots, 1)
        began = time.monotonic()
        with Server(context, data) as server:
            yield at_most("start_to_serving_%d_robots" % robots, time.monotonic() - began, 3.0, "s")
            pages = {"fleet_page": "/", "fleet_last_page": "/?page=%d" % robots, "fleet_search": "/?q=robot-%d+says" % (robots - 1)}
            for key, path in pages.items():
                took_ms = 1e3 * statistics.median(seconds(server.address + path) for _ in range(5))
                yield at_most("%s_%d_robots" % (key, robots), took_ms, 500.0, "ms")
            yield at_most("fleet_poll_p99_%d_robots" % robots, p99_ms(server.address + "/api/v1/live", 300), 5.0, "ms")


def run(context):
    robots, visits = (1000, 52) if context.full else (1000, 12)
    with context.folder() as name:
        folder = pathlib.Path(name)
        fill(context, folder / "data", robots, visits)
        began = time.monotonic()
        with Server(context, folder / "data") as server:
            yield at_most("start_to_serving", time.monotonic() - began, 3.0, "s")
            path = folder / "asked.json"
            path.write_text(json.dumps(Rig().week(1)))
            if server.rigcal("push-edges", path, "--robot", "asked").returncode not in ANSWERED:
                raise RuntimeError("push-edges failed")
            for key, (value_ms, limit_ms) in asked(context, server, 300).items():
                yield at_most("%s_%d_robots_%d_visits" % (key, robots, visits), value_ms, limit_ms, "ms")
            with Pushes(server, folder) as pushes:
                pushes.first.wait(timeout=60)
                for key, (value_ms, limit_ms) in asked(context, server, 300).items():
                    yield at_most("%s_beside_pushes" % key, value_ms, limit_ms, "ms")
                yield at_least("pushes_meanwhile", pushes.pushed, 2)
                yield info("edges_pushed_meanwhile", pushes.edges_per_s(), "/s")
            load = Load(context, server, folder)
            time.sleep(3.0)  # until all of its clients push
            figures = asked(context, server, 300)
            meanwhile = load.process.poll() is None
            rate = load.finish()
            for key, (value_ms, limit_ms) in figures.items():
                yield at_most("%s_beside_5000_edges_per_s" % key, value_ms, limit_ms, "ms")
            yield at_least("edges_stored_meanwhile", rate if meanwhile else 0.0, 5000.0, "/s")
    yield from of_many_robots(context)
    yield from of_one_visit(context, 100_000 if context.full else 10_000)
