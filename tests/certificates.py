"""Certificates for tests of TLS, made by the openssl of the machine."""

import shutil
import subprocess

import pytest

from station.local.tls import TlsFiles


def make_certificate(directory, names="IP:127.0.0.1", name="station", password=""):
    """Return a new self-signed certificate and its key; skip without openssl.

    Args:
        directory: Where the files go.
        names: What the certificate is for, as openssl writes it.
        name: Stem of the files.
        password: Protects the key; none when empty.
    """
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("the program `openssl` is not on PATH; it makes the certificate")
    files = TlsFiles(directory / f"{name}.crt", directory / f"{name}.key")
    protection = ["-passout", f"pass:{password}"] if password else ["-nodes"]
    subprocess.run(
        [
            *(openssl, "req", "-x509", "-newkey", "ec", *protection),
            *("-pkeyopt", "ec_paramgen_curve:prime256v1", "-days", "1"),
            *("-subj", f"/CN={name}", "-addext", f"subjectAltName={names}"),
            *("-out", str(files.certificate), "-keyout", str(files.key)),
        ],
        check=True,
        capture_output=True,
    )
    return files
