"""How long the report of a large rig takes: 12 sensors, 59 edges of 40 captures, from the store to the published folder."""
import json
import pathlib
import subprocess

from ..measure import at_most


def run(context):
    with context.folder() as temporary:
        folder = pathlib.Path(temporary) / "store"
        done = subprocess.run([str(context.bin / "page_store"), "render", str(folder)], capture_output=True, text=True, timeout=120, check=True)
        times = json.loads(done.stdout)
        yield at_most("whole_report_s", times["whole_s"], 5.0, "s")
        yield at_most("one_edge_changed_s", times["changed_s"], 1.0, "s")
