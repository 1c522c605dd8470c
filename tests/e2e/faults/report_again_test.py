"""A report's folder is removed under a running server, and before a start: it comes back as it was."""
import pathlib
import shutil
import sys
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from edges_test import triangle  # noqa: E402
from flow import Flow, check  # noqa: E402

PAGE = "/robots/rig/revisions/1/"


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def status(flow, page=PAGE):
    try:
        with urllib.request.urlopen(flow.address + page, timeout=20) as reply:
            return reply.status, reply.headers, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read().decode()


def await_page(flow, page=PAGE):
    for _ in range(200):
        code, headers, body = status(flow, page)
        if code == 200:
            return
        check(code == 503 and headers["Retry-After"] and "being drawn" in body, "%d while it is drawn: %s" % (code, body))
        flow.rigcal("robots")  # takes its time
    raise SystemExit("FAILED: the report does not come back")


def main():
    with Flow() as flow:
        flow.rigcal("push-edges", triangle(flow.folder), "--robot", "rig")
        await_page(flow)
        folder = flow.server.data / "reports" / "rig" / "1"
        first = files(folder)
        shutil.rmtree(folder)
        await_page(flow)
        check(files(folder) == first, "drawn again with the same bytes")

        shutil.rmtree(folder.parent)
        flow.kill_and_restart()
        await_page(flow)
        check(files(folder) == first, "a start misses it")

        code, headers, body = status(flow, "/robots/rig/revisions/2/")
        check(code == 404 and not headers["Retry-After"] and "has no revision 2" in body, "%d: %s" % (code, body))


if __name__ == "__main__":
    main()
