"""SIGHUP: rigcald reads its settings again; what may change holds at once, the rest is named, a bad file changes nothing.
The service manager is told when it is ready, reads, and lives."""
import json
import pathlib
import signal
import socket
import sys
import time
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

BEFORE = "verbose=false\nthreads=2\n"
AFTER = 'verbose=true\nthreads=3\npublic-url="http://rigs.example.org:8420"\nhttp-name=["rigs.example.net"]\n'


class Manager:
    """As systemd listens."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(path))
        self.socket.settimeout(30)

    def wait_for(self, text):
        while text not in self.socket.recv(4096).decode():
            pass

    def forget(self):
        """What was said until now: where too much waits, the newest is dropped."""
        self.socket.setblocking(False)
        try:
            while self.socket.recv(4096):
                pass
        except BlockingIOError:
            self.socket.settimeout(30)


def log_of(flow):
    return pathlib.Path(str(flow.server.data) + ".log").read_text()


def hang_up(flow, said):
    """Until the log says so for once more."""
    before, until = log_of(flow).count(said), time.monotonic() + 30
    flow.server.process.send_signal(signal.SIGHUP)
    while log_of(flow).count(said) == before:
        check(time.monotonic() < until, "the log says '%s': %s" % (said, log_of(flow)[-600:]))
        check(flow.server.process.poll() is None, "the server goes on")


def status_as(flow, name):
    request = urllib.request.Request(flow.address + "/healthz", headers={"Host": name})
    try:
        with urllib.request.urlopen(request, timeout=20) as reply:
            return reply.status
    except urllib.error.HTTPError as error:
        return error.code


def told_address(flow):
    return json.loads(flow.rigcal("status", "--json").stdout)["http_address"]


def limits(flow):
    return json.loads(flow.get("/api/v1/health"))["limits"]


def changes(flow, settings, limits_file):
    settings.write_text(AFTER)
    limits_file.write_text("open_sessions: 7\nhttp_connections: 9\n")
    check(status_as(flow, "rigs.example.org") == 421, "nobody asks by a name that was not given")
    hang_up(flow, "the settings were read anew: changed --verbose, --public-url, --http-name, limit open_sessions = 7")
    check("these settings need a restart: --threads, limit http_connections = 9" in log_of(flow), "what needs a restart is said")
    check(told_address(flow) == "http://rigs.example.org:8420", "robots are told the new address")
    check((status_as(flow, "rigs.example.org"), status_as(flow, "rigs.example.net")) == (200, 200), "and browsers may use it")
    check((limits(flow)["open_sessions"], limits(flow)["http_connections"]) == (7, 64), "limits: %r" % limits(flow))
    flow.rigcal("status")
    check(" debug " in log_of(flow), "every event is logged")


def keeps(flow, file, content, why):
    good = file.read_text()
    file.write_text(content)
    hang_up(flow, "settings were read anew, and those of before stay: ")
    last = [line for line in log_of(flow).splitlines() if "those of before stay" in line][-1]
    check(why in last, "it says why: " + last)
    check((told_address(flow), limits(flow)["open_sessions"]) == ("http://rigs.example.org:8420", 7), "all stays as it was")
    file.write_text(good)


def main():
    flow = Flow()
    settings, limits_file = flow.folder / "rigcald.conf", flow.folder / "limits.yaml"
    settings.write_text(BEFORE)
    limits_file.write_text("")
    manager = Manager(flow.folder / "manager")
    plain = flow.server.environment
    flow.server.environment = lambda: {**plain(), "RIGCAL_CONFIG": str(settings), "NOTIFY_SOCKET": str(flow.folder / "manager"), "WATCHDOG_USEC": "2000000"}
    flow.arguments = ("--limits", str(limits_file))
    with flow:
        manager.wait_for("READY=1")
        manager.wait_for("WATCHDOG=1")
        hang_up(flow, "the settings were read anew: nothing changed")
        manager.wait_for("RELOADING=1")
        manager.wait_for("READY=1")
        changes(flow, settings, limits_file)
        keeps(flow, settings, "threds=2\n", "threds")
        keeps(flow, settings, AFTER.replace("http://rigs", "rigs"), "public")
        for name, told in (('"*"', '--http-name "*" is no name'), ('"ev il"', '--http-name "ev il" is no name'), ("", '--http-name "" is no name')):
            keeps(flow, settings, AFTER.replace('["rigs.example.net"]', name), told)
        keeps(flow, limits_file, "open_sessions: many\n", "open_sessions")
        hang_up(flow, "the settings were read anew: nothing changed")
        manager.forget()
        flow.server.process.send_signal(signal.SIGTERM)
        manager.wait_for("STOPPING=1")
        check(flow.server.process.wait(timeout=60) == 0, "and ends well")
    print("reload: good")


main()
