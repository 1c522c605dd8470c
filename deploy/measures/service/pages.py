"""What pages weigh and how soon they can be used: in Chromium, from a real server."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

from ..measure import at_most, equal, info, skip
from ..server import Server


def browser():
    return os.environ.get("RIGCAL_CHROMIUM") or shutil.which("chromium")


class PageServer:
    """The pages of a store, without DDS."""

    def __init__(self, context, store):
        self.command = [str(context.bin / "page_store"), "serve", str(store)]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        return self.process.stdout.readline().split()[1]

    def __exit__(self, *_):
        self.process.communicate(timeout=30)


def browse(context, script, address, path, scratch, **more):
    facts = {"address": address, "chromium": browser(), "scratch": str(scratch), "path": path, **more}
    environment = {**os.environ, "NODE_PATH": str(context.root / "build" / "release" / "web-static" / "node_modules")}
    done = subprocess.run(["node", str(context.root / "tests" / "browser" / script), json.dumps(facts)],
                          capture_output=True, text=True, timeout=120, env=environment)
    if done.returncode != 0:
        raise RuntimeError(script + ": " + done.stderr[-500:])
    return json.loads(done.stdout)


def cloud_seconds(context, server, store):
    """Two million points on the report's page, from the click until they are drawn."""
    sys.path.insert(0, str(context.root / "tests" / "browser"))
    from made_cloud import write_cloud
    write_cloud(store / "reports" / "mars" / "2", 2_000_000)
    return browse(context, "cloud.cjs", server.address, "/robots/mars/revisions/2/", store)["visible_s"]


def first_contents(context, server, folder):
    """Of a report, its robot and a page with hardly a word on it: what the browser takes for itself."""
    paths = {"report": "/robots/mars/revisions/2/", "robot": "/robots/mars/", "empty_page": "/experiments/"}
    shown_s = browse(context, "first_content.cjs", server.address, "", folder, paths=list(paths.values()), draws="plainly")
    for name, seconds in zip(paths, shown_s):
        row = "first_content_%s_s" % name
        yield info(row, seconds, "s") if name == "empty_page" else at_most(row, seconds, 0.5, "s")


def run(context):
    if browser() is None or shutil.which("node") is None:
        yield skip("pages", "no chromium or no node")
        return
    with context.folder() as temporary:
        folder = pathlib.Path(temporary)
        for mode, arguments in (("render", []), ("fleet", ["5000"])):
            subprocess.run([str(context.bin / "page_store"), mode, str(folder / mode), *arguments], check=True, stdout=subprocess.DEVNULL)
        with Server(context, folder / "render") as server:
            report = browse(context, "weigh.cjs", "", server.address + "/robots/mars/revisions/2/", folder)
            yield at_most("report_weight_MB", report["bytes"] / 1e6, 2.5, "MB")
            yield at_most("report_first_content_s", report["first_content_s"], 1.0, "s")
            yield at_most("report_rig_drawn_s", report["ready_s"], 5.0, "s")
            yield from first_contents(context, server, folder)
            yield at_most("cloud_2M_visible_s", cloud_seconds(context, server, folder / "render"), 4.0, "s")
        with PageServer(context, folder / "fleet") as address:
            fleet = browse(context, "weigh.cjs", "", address + "/", folder)
            yield equal("fleet_robots", fleet["count"], "5000 robots")
            yield at_most("fleet_5000_interactive_s", fleet["ready_s"], 1.5, "s")
            yield at_most("fleet_5000_search_s", fleet["search_s"], 1.5, "s")
