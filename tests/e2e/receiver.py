"""Who is told of changes, as a test: takes alerts, and looks whether they are signed."""
import hashlib
import hmac
import http.server
import json
import threading
import time

SECRET = "a secret of thirty-two characters"


class Receiver:
    """Takes what is posted; `answer` is called with the alert and gives the HTTP status, or None to hang up."""

    def __init__(self, answer, port=0):
        self.taken, self.wrong, self.answer = [], [], answer
        receiver = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                receiver.look(self.headers, body)
                status = receiver.answer(json.loads(body))
                if status is None:
                    self.close_connection = True
                    return
                if 200 <= status < 300:
                    receiver.taken.append(json.loads(body))
                self.send_response(status)
                self.send_header("Content-Length", "0")
                self.end_headers()

            def log_message(self, *_):
                pass

        self.http = http.server.ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self.port = self.http.server_port
        threading.Thread(target=self.http.serve_forever, daemon=True).start()

    def look(self, headers, body):
        signed = hmac.new(SECRET.encode(), headers["X-Rigcal-Timestamp"].encode() + b"." + body, hashlib.sha256)
        if headers["X-Rigcal-Signature"] != "sha256=" + signed.hexdigest() or headers["X-Rigcal-Id"] != json.loads(body)["id"]:
            self.wrong.append(dict(headers))
        if abs(time.time() - int(headers["X-Rigcal-Timestamp"])) > 300:
            self.wrong.append(dict(headers))

    def stop(self):
        self.http.shutdown()
        self.http.server_close()
