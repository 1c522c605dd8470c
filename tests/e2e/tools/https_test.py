"""rigcald over TLS: curl trusts it, plain HTTP is told so, files that will not do end it with one sentence, SIGHUP reads them anew."""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from flow import Flow, check  # noqa: E402
from made_certificate import make_certificate  # noqa: E402


def curl(*arguments):
    return subprocess.run(["curl", "-sS", "--max-time", "20", *map(str, arguments)], capture_output=True, text=True)


def serves(flow, certificate, key):
    flow.server.start("--http-cert", str(certificate), "--http-key", str(key))
    address = flow.ready()
    check(address.startswith("https://127.0.0.1:"), "the server says where it is: " + address)
    for version in ("--tlsv1.2", "--tls-max 1.2"):
        got = curl(*version.split(), "--cacert", certificate, address + "/healthz")
        check(json.loads(got.stdout)["state"] == "ok", "%s: %s%s" % (version, got.stdout, got.stderr))
    check(curl("--tls-max", "1.1", "--ciphers", "ALL:@SECLEVEL=0", "--cacert", certificate, address + "/healthz").returncode != 0, "TLS 1.1 is refused")
    check(curl(address + "/healthz").returncode == 60, "who does not know the certificate does not trust it")
    plain = curl(address.replace("https", "http") + "/")
    check("https://" in plain.stdout, "plain HTTP is told so: " + plain.stdout + plain.stderr)
    told = json.loads(flow.rigcal("status", "--json").stdout)["http_address"]
    check(told == address, "robots and people are told it: " + told)
    return address


def read_anew(flow, address, certificate, key):
    """The files' places keep their names, as those of a renewed certificate do."""
    old, newer = certificate.read_bytes(), make_certificate(flow.folder, "newer")
    shutil.copy(newer[0], certificate)
    shutil.copy(newer[1], key)
    flow.server.process.send_signal(signal.SIGHUP)
    until = time.monotonic() + 20
    while curl("--cacert", newer[0], address + "/healthz").returncode != 0:
        check(time.monotonic() < until, "the new certificate is shown")
    key.write_bytes(b"nonsense")
    certificate.write_bytes(old)
    flow.server.process.send_signal(signal.SIGHUP)
    log = pathlib.Path(str(flow.server.data) + ".log")
    while "the certificate of before is still shown" not in log.read_text():
        check(time.monotonic() < until, "a bad one is told in the log")
    check(curl("--cacert", newer[0], address + "/healthz").returncode == 0, "and the one of before goes on")


def refused(flow, what, *arguments):
    flow.server.start(*map(str, arguments))
    flow.server.process.wait(timeout=60)
    check(flow.server.process.returncode == 1, "%s: exit %r" % (what, flow.server.process.returncode))
    flow.server.stop()
    said = pathlib.Path(str(flow.server.data) + ".log").read_text().splitlines()[-1]
    check(what in said, "it says why: " + said)


def main():
    flow = Flow()
    certificate, key = make_certificate(flow.folder, "rigs")
    other = make_certificate(flow.folder, "other")
    try:
        address = serves(flow, certificate, key)
        read_anew(flow, address, certificate, key)
        flow.server.stop()
        refused(flow, "cannot be read as a private key", "--http-cert", certificate, "--http-key", key)
        refused(flow, "is not the key of the certificate", "--http-cert", certificate, "--http-key", other[1])
        refused(flow, "--http-key stands alone", "--http-key", key)
        refused(flow, "cannot be read as a certificate", "--http-cert", flow.folder / "none.pem", "--http-key", key)
    finally:
        flow.server.stop()
        flow.temporary.cleanup()
    print("https: good")


main()
