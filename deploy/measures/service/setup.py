"""The first thing that people run, after the build. With --full also a fresh clone, both commands of the README, a cold
compiler cache: time and disk; the package in a fresh Debian."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import uuid

from ..measure import at_most, equal, info, processors, skip


def timed(command, clone, environment):
    start = time.perf_counter()
    done = subprocess.run(command, cwd=clone, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise RuntimeError("%s: exit %d: %s" % (command, done.returncode, done.stdout[-500:]))
    return time.perf_counter() - start


def package(context):
    """Builds the package from the binaries that are there, and uses it in a fresh Debian root."""
    subprocess.run(["cpack", "-G", "DEB", "--config", "build/release/CPackConfig.cmake"], cwd=context.root, check=True, stdout=subprocess.DEVNULL)
    built = max((context.root / "build" / "release").glob("rigcal_*.deb"), key=lambda path: path.stat().st_mtime)
    yield info("package_size_MiB", built.stat().st_size / 2**20)
    if os.geteuid() != 0 and shutil.which("sudo") is None:
        yield skip("package_smoke", "not run: needs root or sudo")
        return
    done = subprocess.run(["deploy/smoke-package", str(built)], cwd=context.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    figures = dict(re.findall(r"^(package_\w+) (\d+)$", done.stdout, re.MULTILINE))
    if done.returncode != 0 or "package_install_s" not in figures:
        print(done.stdout[-2000:], file=sys.stderr)
        yield equal("package_smoke", 0, 1)
        return
    yield info("package_install_s", int(figures["package_install_s"]))
    yield equal("package_smoke", int(figures["package_smoke"]), 1)


def quickstart(context):
    """From nothing but binaries: the session is drawn, pushed, calibrated, shown."""
    subprocess.run(["deploy/build", "rigcald", "rigcal"], cwd=context.root, check=True, stdout=subprocess.DEVNULL)
    environment = {**os.environ, "RIGCAL_DDS_TAG": "measure-" + uuid.uuid4().hex[:12], "RIGCAL_DDS_LOCAL": "1"}
    with context.folder() as work, processors(2):
        start = time.perf_counter()
        done = subprocess.run(["deploy/quickstart", "--once", "--work", work], cwd=context.root, env=environment, capture_output=True,
                              text=True, timeout=900)
        took_s = time.perf_counter() - start
    if done.returncode != 0:
        raise RuntimeError("deploy/quickstart: exit %d: %s" % (done.returncode, (done.stdout + done.stderr)[-500:]))
    yield at_most("quickstart_2_processors", took_s, 180.0, "s")
    yield equal("quickstart_good_edges", len(re.findall(r"^\w+ - \w+  \w+  good  ", done.stdout, re.MULTILINE)), 59)
    # Beside the reference, at which both are laid together.
    yield equal("quickstart_poses_beside_truth", len(re.findall(r"^\w+( +[\d.]+){4}  +[\d.]+ sigma$", done.stdout, re.MULTILINE)), 11)


def run(context):
    yield from quickstart(context)
    if not context.full:
        yield skip("package_smoke", "not run: only with --full")
        yield skip("fresh_clone", "only with --full")
        return
    yield from package(context)
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
