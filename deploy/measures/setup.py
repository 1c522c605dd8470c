"""A fresh clone, both commands of the README, a cold compiler cache: time and disk. Only with --full."""
import os
import pathlib
import subprocess
import time

from .measure import at_most, info, skip


def timed(command, clone, environment):
    start = time.perf_counter()
    done = subprocess.run(command, cwd=clone, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise RuntimeError("%s: exit %d: %s" % (command, done.returncode, done.stdout[-500:]))
    return time.perf_counter() - start


def run(context):
    if not context.full:
        yield skip("fresh_clone", "only with --full")
        return
    with context.folder() as temporary:
        clone = pathlib.Path(temporary) / "clone" / "rigcal"
        subprocess.run(["git", "clone", "--quiet", str(context.root), str(clone)], check=True)
        if context.data.is_dir():
            (clone.parent / "shared").symlink_to(context.data.parent)
        environment = {**os.environ, "CCACHE_DISABLE": "1", "RIGCAL_DDS_TAG": "setup-%d" % os.getpid(), "RIGCAL_DDS_LOCAL": "1"}
        yield info("quickstart_cold", timed(["./deploy/quickstart", "--once"], clone, environment) / 60, "min")
        yield at_most("test_cold", timed(["./deploy/test"], clone, environment) / 60, 30.0, "min")
        yield info("quickstart_again", timed(["./deploy/quickstart", "--once"], clone, environment), "s")
        used = subprocess.run(["du", "-sm", str(clone)], capture_output=True, text=True, check=True).stdout.split()[0]
        yield info("disk_used", int(used), "MiB")
