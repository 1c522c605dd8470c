"""Logging in and out in Chromium, without a script and over TLS, from a link of another site too."""
import http.server
import subprocess
import sys
import threading

from stage import check, run_script, skip_without_browser
from flow import Flow  # noqa: E402
from made_certificate import make_certificate

PASSWORD = "correct horse battery"


class OtherSite(http.server.BaseHTTPRequestHandler):
    """One page, whose link leads to the server."""
    target = ""

    def do_GET(self):
        page = ('<a href="%s">the robot</a>' % self.target).encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(page)))
        self.end_headers()
        self.wfile.write(page)

    def log_message(self, *_):
        pass


def main():
    skip_without_browser()
    flow = Flow()
    certificate, key = make_certificate(flow.folder, "rigs")
    other = http.server.ThreadingHTTPServer(("127.0.0.1", 0), OtherSite)
    threading.Thread(target=other.serve_forever, daemon=True).start()
    try:
        flow.server.start("--http-cert", str(certificate), "--http-key", str(key))
        flow.address = flow.ready().replace("127.0.0.1", "localhost")
        done = subprocess.run(flow.server.client("user", "add", "ada", "--role", "approver", "--data", flow.server.data), input=PASSWORD + "\n",
                              capture_output=True, text=True, env=flow.server.environment(), timeout=120)
        check(done.returncode == 0, "ada is made: " + done.stderr)
        OtherSite.target = flow.address + "/boards/"
        run_script(flow, "login.cjs", password=PASSWORD, other="http://127.0.0.1:%d/" % other.server_port)
    finally:
        other.shutdown()
        flow.server.stop()
        flow.temporary.cleanup()
    print("login: good")


if __name__ == "__main__":
    sys.exit(main())
