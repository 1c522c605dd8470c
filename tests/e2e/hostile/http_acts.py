"""What a hostile program may do over HTTP, act by act, on bare sockets, and how each must end: refused or bounded."""
import contextlib
import os
import pathlib
import socket
import time

PATIENCE_S = 15
HALF_OPEN, STORM = 1000, 1000
LARGE, LARGE_BYTES = "/robots/rig/revisions/1/large.bin", 30_000_000


def put_large_file(data):
    """What LARGE is, in a server's data folder: more than the system keeps for who does not read."""
    folder = data / "reports" / "rig" / "1"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "large.bin").write_bytes(b"x" * LARGE_BYTES)


def connections(pid):
    """How many sockets a server holds. Files are not counted: each thread that answers opens the store when it first has to."""
    count = 0
    for handle in pathlib.Path("/proc/%d/fd" % pid).iterdir():
        with contextlib.suppress(FileNotFoundError):  # closed meanwhile
            count += os.readlink(handle).startswith("socket:")
    return count


def connected(port):
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)


def exchange(port, request):
    """All that the server sends until it closes; what it did not want to read any more does not matter."""
    with connected(port) as one:
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            one.sendall(request)
        answer = b""
        with contextlib.suppress(ConnectionResetError):
            while piece := one.recv(65536):
                answer += piece
        return answer


def request(target="/healthz", method="GET", headers=("Host: localhost",)):
    return "\r\n".join(["%s %s HTTP/1.1" % (method, target), *headers, "", ""]).encode("latin-1")


def status_of(answer):
    return int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else 0


def seconds_of_question(port):
    """Of somebody else's question; endless where it fails."""
    begun = time.monotonic()
    try:
        ok = status_of(exchange(port, request())) == 200
    except OSError:
        ok = False
    return time.monotonic() - begun if ok else float("inf")


def answered(*statuses, once=True, without=b""):
    """One answer with one of these statuses; 0: closed without any."""
    def judge(answer):
        if status_of(answer) not in statuses:
            return "answered %r" % answer[:80]
        if once and answer.count(b"HTTP/1.1 ") > 1:
            return "answered more than once"
        return "answered with what was sent" if without and without in answer.split(b"\r\n\r\n")[0] else ""
    return judge


REFUSED = answered(0, 400, 403, 404, 405, 413, 414, 421, 431)
LOCAL = "Host: localhost"
# name, what is sent, how it must end
SENT = [
    ("name_pointed_here", request(headers=["Host: evil.example"]), answered(421)),
    ("name_below_ours", request(headers=["Host: localhost.evil.example:80"]), answered(421)),
    ("no_host", request(headers=[]), answered(400)),
    ("two_hosts", request(headers=[LOCAL, "Host: evil.example"]), answered(400)),
    ("other_sites_page", request(headers=[LOCAL, "Origin: http://evil.example"]), answered(403)),
    ("page_of_nobody", request(headers=[LOCAL, "Origin: null"]), answered(403)),
    ("whole_address", request("http://evil.example/healthz"), answered(0, 400, 421)),
    ("parent_folder", request("/robots/rig/revisions/1/../../../../store.db"), answered(400)),
    ("parent_folder_encoded", request("/robots/rig/revisions/1/%2e%2e/%2E%2E/x"), answered(400)),
    ("slash_encoded", request("/robots/rig/revisions/1/..%2f..%2fx"), answered(400)),
    ("encoded_twice", request("/robots/rig/revisions/1/%252e%252e/x"), answered(404)),
    ("overlong_utf8", request("/robots/rig/revisions/1/%c0%ae%c0%ae/x"), answered(400, 404)),
    ("zero_byte", request("/style.css%00.html"), answered(400)),
    ("backslash", request("/..%5c..%5cx"), answered(400)),
    ("hidden_file", request("/robots/rig/.hidden"), answered(400)),
    ("half_an_escape", request("/%zz"), answered(400)),
    ("header_in_path", request("/%0d%0aSet-Cookie:%20a=b"), answered(400, without=b"Set-Cookie")),
    ("long_question", request("/api/v1/lookup?a=" + "x" * 15000), REFUSED),
    ("writes", request(method="DELETE", target="/robots/rig/revisions/1/"), answered(405)),
    ("body_of_a_terabyte", request(method="POST", headers=[LOCAL, "Content-Length: 1099511627776"]) + b"x" * 1_000_000, answered(0, 405)),
    ("body_without_end", request(method="POST", headers=[LOCAL, "Transfer-Encoding: chunked"]) + b"5\r\nhello\r\n" * 10_000, answered(0, 405)),
    ("request_in_a_body", request(headers=[LOCAL, "Content-Length: 4", "Transfer-Encoding: chunked"]) + b"0\r\n\r\n" + request("/"), answered(0, 200, 400)),
    ("thousand_at_once", request() * 1000, answered(0, 200)),
    ("head_of_a_megabyte", request(headers=[LOCAL, "X: " + "a" * (1 << 20)]), REFUSED),
    ("ten_thousand_headers", request(headers=[LOCAL] + ["X: a"] * 10_000), REFUSED),
    ("tls", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\x00" * 500, REFUSED),
    ("ranges", request("/style.css", headers=[LOCAL, "Range: bytes=" + ",".join(["0-"] * 3000)]), answered(0, 200, 400)),
]


@contextlib.contextmanager
def half_open(port):
    held = []
    try:
        for idx in range(HALF_OPEN):
            held.append(connected(port))
            if idx % 2:
                held[-1].sendall(b"GET / HTTP/1.1\r\nHos")
        yield
    finally:
        for one in held:
            one.close()


@contextlib.contextmanager
def deaf(port):
    """They ask, and take nothing of the answer."""
    held = []
    try:
        for _ in range(100):
            one = socket.socket()
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
            one.settimeout(PATIENCE_S)
            one.connect(("127.0.0.1", port))
            one.sendall(request(LARGE))
            held.append(one)
        yield
    finally:
        for one in held:
            one.close()


@contextlib.contextmanager
def storm(port):
    """Comes and goes at once."""
    for _ in range(STORM):
        connected(port).close()
    yield


LASTING = [("half_open", half_open), ("deaf", deaf), ("storm", storm)]


def run_sent(port):
    """(name, what is wrong or "") of each act that is a request."""
    return [(name, judge(exchange(port, sent))) for name, sent, judge in SENT]


def run_lasting(port, questions):
    """(name, seconds of so many questions that others ask meanwhile), sorted."""
    outcomes = []
    for name, act in LASTING:
        with act(port):
            outcomes.append((name, sorted(seconds_of_question(port) for _ in range(questions))))
    return outcomes
