"""A support bundle: what is in it with the server up and down, and that no secret is."""
import json
import pathlib
import subprocess
import sys
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402

SECRET = "Plant3dSecret"


def planted(folder):
    """Settings and a log with secrets in them, and keys beside them."""
    (folder / "dds").mkdir(parents=True)
    (folder / "rigcald.env").write_text("RIGCAL_STORE=postgresql://rigcal:%s@db/rigcal\nRIGCALD_OPTIONS=\"--threads 3\"\n" % SECRET)
    (folder / "rigcald.conf").write_text("http-key=\"/etc/rigcal/rigs.key\"\nwebhook_secret=%s\n" % SECRET)
    for name in ("rigs.key", "dds/identity.key", "webhook-secret"):
        (folder / name).write_text(SECRET)
    log = folder.parent / "rigcald.log"
    log.write_text("a line\nAuthorization: Bearer %s\npassword=%s\n-----BEGIN PRIVATE KEY-----\n%s\n-----END PRIVATE KEY-----\nthe end\n" % (SECRET, SECRET, SECRET))
    return log


def bundle(flow, settings, log, *arguments):
    out = flow.folder / "support.zip"
    done = subprocess.run(flow.server.client("support-bundle", "--json", "--out", out, "--data", flow.server.data, "--settings", settings, "--log", log,
                                             "--timeout", "2", *arguments), capture_output=True, text=True, timeout=120, env=flow.server.environment())
    check(done.returncode == 0, "it is written: %d %s" % (done.returncode, done.stderr))
    told = json.loads(done.stdout)
    check(told["file"] == str(out) and out.stat().st_mode & 0o777 == 0o600, "for its user alone: %r" % told)
    with zipfile.ZipFile(out) as archive:
        texts = {name: archive.read(name).decode() for name in archive.namelist()}
    for name, text in texts.items():
        check(SECRET not in text, "no secret is in %s" % name)
    missing = sorted(part["name"] for part in told["parts"] if part["missing"])
    check(sorted(name[:-len(".missing")] for name in texts if name.endswith(".missing")) == missing, "what is missing is told: %r" % missing)
    return texts, missing


def check_always(texts):
    check("newest schema" in texts["about.txt"] and "kernel: Linux" in texts["machine.txt"] and "MemTotal" in texts["machine.txt"], "versions and machine")
    check("--threads 3" in texts["settings/rigcald.env"] and "[redacted]" in texts["settings/rigcald.env"], "settings, without secrets")
    check("a line" in texts["log.txt"] and "the end" in texts["log.txt"], "the log")
    figures = json.loads(texts["store.json"])
    check(figures["schema_version"] > 30 and "session" in figures["rows"] and "waiting_job" in figures["queues"], "sizes: %r" % figures)
    check(texts["fsck.txt"].startswith("0 things are damaged"), texts["fsck.txt"])


def main():
    flow = Flow()
    try:
        settings = flow.folder / "etc"
        log = planted(settings)
        flow.server.start()
        flow.address = flow.ready()
        texts, missing = bundle(flow, settings, log, "--url", flow.address)
        check_always(texts)
        check(missing == ["settings/identity.txt", "settings/limits.yaml", "settings/worker.env"], "all of the server is there: %r" % missing)
        check(texts["server/readyz.txt"].startswith("status 200") and "rigcal_" in texts["server/metrics.txt"], "readiness and metrics")
        check("version" in json.loads(texts["server/health.json"]), "what it says over DDS")
        flow.server.stop()
        texts, missing = bundle(flow, settings, log, "--url", flow.address)
        check_always(texts)
        check({"server/health.json", "server/readyz.txt", "server/metrics.txt"} <= set(missing), "a server that is down: %r" % missing)
        done = subprocess.run(flow.server.client("support-bundle", "--no-fsck", "--log", log, "--out", flow.folder / "none" / "x.zip", "--timeout", "1"),
                              capture_output=True, text=True, timeout=60, env=flow.server.environment())
        check(done.returncode == 4 and "cannot be written" in done.stderr, "it is told: " + done.stderr)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("support bundle: good")


main()
