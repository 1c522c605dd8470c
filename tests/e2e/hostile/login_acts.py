"""What a hostile program may do about logins and orders over HTTP, act by act, and how each must end: refused."""
import concurrent.futures
import json
import re
import subprocess
import time
import urllib.parse

import http_acts

PASSWORD, OTHER_PASSWORD = "correct horse battery", "another long password"
FLOOD = 60


def keep(server, *arguments, said=""):
    """`rigcal user` or `rigcal token` on the folder of a server that runs: what it prints."""
    done = subprocess.run(server.client(*arguments, "--data", server.data), input=said, capture_output=True, text=True,
                          env=server.environment(), timeout=120)
    if done.returncode != 0:
        raise RuntimeError("rigcal %s: %s" % (" ".join(arguments), done.stderr))
    return done.stdout.strip()


class Visitor:
    """A browser's cookies, and what it sends."""
    def __init__(self, port):
        self.port, self.cookies = port, {}

    def ask(self, target, fields=None, origin="own", headers=(), body=None, kind="application/x-www-form-urlencoded"):
        """(status, answer as text). `fields`: posted as a form; `body`: posted as it is."""
        sent = urllib.parse.urlencode(fields) if fields is not None else body
        lines = ["Host: localhost", *headers]
        if self.cookies:
            lines.append("Cookie: " + "; ".join("%s=%s" % one for one in self.cookies.items()))
        if sent is not None:
            lines += ["Content-Type: " + kind, "Content-Length: %d" % len(sent)]
            lines += ["Origin: " + ("http://localhost" if origin == "own" else origin)] if origin else []
        whole = http_acts.request(target, "POST" if sent is not None else "GET", lines) + (sent or "").encode()
        answer = http_acts.exchange(self.port, whole)
        text = answer.decode("utf-8", "replace")
        for name, value in re.findall(r"^Set-Cookie: ([^=]+)=([^;]*)", text, re.MULTILINE):
            self.cookies[name] = value
        return http_acts.status_of(answer), text

    def status(self, *arguments, **named):
        return self.ask(*arguments, **named)[0]

    def form(self):
        return re.search('name="form" value="([0-9a-f]{64})"', self.ask("/login")[1]).group(1)

    def log_in(self, name, password, **named):
        return self.status("/login", fields={"name": name, "password": password, "form": self.form()}, **named)

    def order(self, verb, parameters, **named):
        return self.status("/api/v1/" + verb, body=json.dumps(parameters), kind="application/json", **named)

    def session_name(self):
        return next(name for name in self.cookies if "form" not in name and "known" not in name)


POLICY = {"text": "tolerance_mm: 40", "reason": "x"}


def stranger(port):
    nobody = Visitor(port)
    yield "stranger_reads", nobody.status("/api/v1/status") == 401
    yield "stranger_orders", nobody.order("set_policy", POLICY) == 401
    yield "guessed_cookie", not any(_with_cookie(port, "%064x" % number) for number in range(20))
    yield "guessed_token", all(nobody.status("/", headers=["Authorization: Bearer %064x" % number]) == 401 for number in range(20))
    yield "odd_cookie", not any(_with_cookie(port, text) for text in ("", "' OR 1=1 --", "x" * 5000, "%00", "..", "a; b"))


def _with_cookie(port, secret):
    one = Visitor(port)
    one.cookies["rigcal-%d" % port] = secret
    return one.status("/") == 200


def forged(port):
    """Pages of other sites that use the browser of somebody who is logged in."""
    ada = Visitor(port)
    ada.log_in("ada", PASSWORD)
    form = ["X-Rigcal-Form: " + ada.form()]
    yield "logged_in_at_all", ada.status("/") == 200
    for name, origin in (("forged_origin", "http://evil.example"), ("origin_of_nobody", "null"), ("no_origin", None), ("origin_of_another_port", "http://localhost:1")):
        yield name, ada.order("set_policy", POLICY, origin=origin, headers=form) == 403
    yield "order_without_form_token", ada.order("set_policy", POLICY) == 403
    yield "order_as_a_form", ada.status("/api/v1/set_policy", fields=POLICY, headers=form) == 415
    yield "order_by_get", ada.status("/api/v1/set_policy?text=x&reason=x&who=ada") in (400, 404)
    yield "order_as_somebody_else", ada.order("set_policy", {**POLICY, "who": "eve"}, headers=form) == 400
    yield "logout_by_another_site", ada.status("/logout", fields={"form": "x"}, origin="http://evil.example") == 403 and ada.status("/") == 200


def stolen(port, server):
    """Cookies that were good once, and such that were planted."""
    ada = Visitor(port)
    ada.log_in("ada", PASSWORD)
    stolen_one = ada.cookies[ada.session_name()]
    ada.status("/logout", fields={"form": ada.form()})
    yield "cookie_after_logout", not _with_cookie(port, stolen_one)
    fixed = Visitor(port)
    fixed.cookies["rigcal-%d" % port] = "a" * 64
    fixed.log_in("ada", PASSWORD)
    yield "planted_session", fixed.cookies["rigcal-%d" % port] != "a" * 64 and not _with_cookie(port, "a" * 64)
    keep(server, "user", "password", "ada", said=OTHER_PASSWORD + "\n")
    yield "cookie_of_an_older_password", fixed.status("/") == 401
    yield "older_password", fixed.log_in("ada", PASSWORD) == 403


def viewer(port, server):
    vic = Visitor(port)
    vic.log_in("vic", PASSWORD)
    form = ["X-Rigcal-Form: " + vic.form()]
    yield "viewer_posts", all(vic.order(verb, {"reason": "x"}, headers=form) == 403 for verb in ("approve", "retire", "set_policy", "epoch"))
    token = keep(server, "token", "new", "reader", "--role", "viewer")
    bearer = ["Authorization: Bearer " + token]
    yield "token_of_a_viewer_posts", Visitor(port).order("approve", {"reason": "x"}, headers=bearer) == 403
    keep(server, "token", "revoke", "reader")
    yield "revoked_token", Visitor(port).status("/", headers=bearer) == 401


def run(server, port):
    """(name, what is wrong or "") of each act, after two users were made; the last one floods."""
    for name, role in (("ada", "admin"), ("vic", "viewer")):
        keep(server, "user", "add", name, "--role", role, said=PASSWORD + "\n")
    outcomes = []
    for acts in (stranger(port), forged(port), stolen(port, server), viewer(port, server)):
        outcomes += [(name, "" if is_refused else "not refused") for name, is_refused in acts]
    return outcomes


def flood(port, questions):
    """(statuses of so many guesses at once, seconds of so many questions that others ask meanwhile, sorted)."""
    begun = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(8) as crowd:
        guesses = [crowd.submit(Visitor(port).log_in, "ada", "guess number %d" % number) for number in range(FLOOD)]
        seconds = sorted(http_acts.seconds_of_question(port) for _ in range(questions))
        statuses = [one.result() for one in guesses]
    if time.monotonic() - begun > 120:
        raise RuntimeError("the flood took too long to say anything")
    return statuses, seconds
