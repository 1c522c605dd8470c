"""What `cmake --install` leaves: programs that run, man pages with every verb, and nothing that needs the sources."""
import gzip
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import ROOT, check  # noqa: E402

BUILD = pathlib.Path(os.environ["RIGCAL_BUILD"])
WANTED = ["bin/rigcal", "bin/rigcald", "libexec/rigcal/rigcal-simulate", "libexec/rigcal/rigcal-check", "libexec/rigcal/rigcal-companion", "libexec/rigcal/rigcal-board", "libexec/rigcal/rigcal-import", "libexec/rigcal/rigcal-upkeep", "share/man/man1/rigcal.1.gz", "share/man/man8/rigcald.8.gz",
          "share/bash-completion/completions/rigcal", "share/zsh/vendor-completions/_rigcal", "share/fish/vendor_completions.d/rigcal.fish",
          "lib/systemd/system/rigcald.service", "lib/systemd/system/rigcal-worker@.service", "etc/rigcal/limits.yaml", "etc/rigcal/rigcald.env",
          "etc/rigcal/rigcald.conf", "etc/rigcal/worker.env", "share/doc/rigcal/rigcal.spdx.json",
          "share/doc/rigcal/README.md", "share/doc/rigcal/copyright", "share/doc/rigcal/LICENSE",
          "share/doc/rigcal/changelog.gz", "share/doc/rigcal/docs/limits.md",
          "lib/librigcal.so.0", "include/rigcal/client.h", "lib/python3/dist-packages/rigcal/py.typed"]


def output(*command, **more):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, timeout=100, **more).stdout


def check_programs(prefix):
    version = re.search(r"project\(rigcal VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    for name in ("rigcal", "rigcald"):
        said = output(prefix / "bin" / name, "--version", cwd=prefix).decode()
        check(said.startswith("%s %s" % (name, version)), "%s --version: %s" % (name, said))


def check_man_pages(prefix):
    page = gzip.decompress((prefix / "share/man/man1/rigcal.1.gz").read_bytes()).decode()
    told = output(prefix / "bin/rigcal", "--help").decode()
    verbs = re.findall(r"^  ([a-z-]+) ", told.partition("Subcommands:")[2].partition("\n\n")[0], re.MULTILINE)
    check(len(verbs) > 10, "the verbs are found: %r" % verbs)
    for verb in verbs:
        check("\n.SS %s\n" % verb.replace("-", "\\-") in page, "rigcal(1) describes " + verb)
    check("session.yaml" in page or "session folder" in page, "rigcal(1) has the meaning of the options")
    again = prefix / "again.gz"
    subprocess.run([sys.executable, "-B", ROOT / "deploy/packaging/manpage.py", prefix / "bin/rigcal", "1",
                    re.search(r'"rigcal (\S+)"', page).group(1), again],
                   check=True, env={**os.environ, "HOME": "/nowhere", "RIGCAL_LIMITS": "x", "TZ": "Asia/Tokyo"})
    check(gzip.decompress(again.read_bytes()).decode() == page, "the same help gives the same page")


def check_free_of_the_sources(prefix):
    for path in sorted(prefix.rglob("*")):
        if path.is_file():
            check(os.fsencode(ROOT) not in path.read_bytes(), "%s does not name the source folder" % path)


def check_settings(prefix):
    unit = (prefix / "lib/systemd/system/rigcald.service").read_text()
    wished = "Environment=RIGCAL_DDS_IDENTITY=-%s/etc/rigcal/dds\n" % prefix
    check(wished in unit and unit.index(wished) < unit.index("EnvironmentFile="), "identities are on once they are there, unless rigcald.env names others")
    check("ExecStart=%s/bin/rigcald " % prefix in unit, "the unit starts the installed program: " + unit)
    settings = (prefix / "etc/rigcal/rigcald.env").read_text()
    check("RIGCAL_LIMITS=%s/etc/rigcal/limits.yaml" % prefix in settings, "the settings name the installed limits: " + settings)
    offered = re.findall(r"^# (\w+):", (prefix / "etc/rigcal/limits.yaml").read_text(), re.MULTILINE)
    told = output(prefix / "bin/rigcald", "--help").decode().partition("may be repeated: ")[2].partition("\n")[0]
    check(offered == told.split(", "), "limits.yaml offers what --limit takes: %r, %r" % (offered, told))


def main():
    with tempfile.TemporaryDirectory(prefix="rigcal-install-") as folder:
        prefix = pathlib.Path(folder).resolve() / "prefix"
        output("cmake", "--install", BUILD, "--strip", "--prefix", prefix)
        for name in WANTED:
            check((prefix / name).is_file(), name + " is installed")
        check_programs(prefix)
        check_free_of_the_sources(prefix)
        check_settings(prefix)
        check_man_pages(prefix)
    print("install: good")


main()
