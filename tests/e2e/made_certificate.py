"""Certificates for tests, made with OpenSSL: they sign themselves, for 127.0.0.1 and localhost."""
import subprocess


def make_certificate(folder, name, days=2):
    """(certificate, key): PEM files in `folder`."""
    certificate, key = folder / (name + ".pem"), folder / (name + ".key")
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", str(days),
                    "-subj", "/CN=" + name, "-addext", "subjectAltName=IP:127.0.0.1,DNS:localhost", "-keyout", str(key),
                    "-out", str(certificate)], check=True, capture_output=True)
    return certificate, key
