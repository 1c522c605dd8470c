"""The Debian packages: two packagings of a build give the same bytes, what the units expose, what lintian says. With --full
also whether builds of one program in two folders agree."""
import hashlib
import pathlib
import re
import shutil
import subprocess

from ..measure import at_most, equal, skip

EXPOSURE_MAX = 1.8
PROGRAM = "rigcal-board"  # a small one


def packages_in(folder, context):
    """{name: sha256} of what cpack makes there."""
    subprocess.run(["cpack", "-G", "DEB", "-B", str(folder), "--config", "build/release/CPackConfig.cmake"], cwd=context.root, check=True,
                   stdout=subprocess.DEVNULL)
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.deb"))}


def exposure(unit):
    told = subprocess.run(["systemd-analyze", "security", "--offline=true", str(unit)], capture_output=True, text=True).stdout
    return float(re.search(r"Overall exposure level for \S+: ([0-9.]+)", told).group(1))


def units(context):
    if shutil.which("systemd-analyze") is None:
        yield skip("exposure", "systemd-analyze is not installed")
        return
    for unit in sorted((context.root / "deploy").glob("*.service")):
        yield at_most("exposure_" + re.sub(r"\W", "_", unit.stem.rstrip("@")), exposure(unit), EXPOSURE_MAX)


def tags(packages):
    if shutil.which("lintian") is None:
        yield skip("lintian_tags", "lintian is not installed")
        return
    told = subprocess.run(["lintian", "--allow-root", "--tag-display-limit=0", "--fail-on", "none", "--display-level", ">=warning",
                           *map(str, packages)], capture_output=True, text=True, timeout=1800).stdout.splitlines()
    found = [line for line in told if re.match(r"[EW]: ", line)]
    yield equal("lintian_tags", len(found), 0, detail=found[:20])


def digest_of_build(folder, context):
    clone = folder / "rigcal"
    subprocess.run(["git", "clone", "--quiet", str(context.root), str(clone)], check=True)
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "build/release", "--target", PROGRAM, "--parallel", "2"]):
        subprocess.run(command, cwd=clone, check=True, stdout=subprocess.DEVNULL)
    program = clone / "build" / "release" / "bin" / PROGRAM
    subprocess.run(["strip", "--strip-unneeded", str(program)], check=True)
    return hashlib.sha256(program.read_bytes()).hexdigest()


def run(context):
    yield from units(context)
    with context.folder() as temporary:
        first, second = (pathlib.Path(temporary, name) for name in ("first", "second"))
        made = packages_in(first, context)
        yield equal("packages", len(made), 4)
        again = packages_in(second, context)
        differing = [name for name in made if made[name] != again.get(name)]
        yield equal("packages_of_other_bytes", len(differing), 0, detail=differing)
        yield from tags(sorted(first.glob("*.deb")))
    if not context.full:
        yield skip("program_of_other_bytes", "not run: only with --full")
        return
    with context.folder() as temporary:
        digests = {digest_of_build(pathlib.Path(temporary, name), context) for name in ("here", "a-folder-of-a-longer-name")}
        yield equal("program_of_other_bytes", len(digests) - 1, 0)
