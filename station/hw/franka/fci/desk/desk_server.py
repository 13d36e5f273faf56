"""Desk on a port of its own, with TLS and a certificate of its own.

The requests are answered in a thread; changes of the arm are made by the
server of libfranka's programs between two of its cycles.
"""

import hashlib
import os
import socket
import ssl
import subprocess
import threading
from functools import partial
from pathlib import Path

import uvicorn

from station.core.errors import StationError
from station.core.user_files import make_private_folder, user_folder
from station.hw.franka.fci.desk.desk_routes import make_app
from station.hw.franka.fci.desk.desk_state import Desk
from station.hw.franka.fci.server.client_port import FciPortError
from station.web.limited_server import SocketProtocol

FIRST_FREE_PORT = 1024
_END = 5.0


class DeskCertificateError(StationError):
    """There is no certificate with which Desk could be served."""

    code = "desk_certificate"


class DeskServer:
    """Serves a Desk until it is closed.

    Args:
        desk: The Desk.
        host: Address to listen at.
        port: TCP port; 0 for any free one. Most clients know 443 alone.
        folder: Folder of the certificate; the user's own folder if None.

    Attributes:
        port: TCP port.
        fingerprint: SHA-256 of the certificate, as hexadecimal digits.

    Raises:
        FciPortError: The port cannot be used.
        DeskCertificateError: There is no certificate, and none can be made.
    """

    def __init__(
        self, desk: Desk, host: str, port: int, folder: Path | None = None
    ) -> None:
        certificate, key = own_certificate(folder or user_folder("desk"))
        der = ssl.PEM_cert_to_DER_cert(certificate.read_text(encoding="ascii"))
        self.fingerprint = hashlib.sha256(der).hexdigest()
        self._listener = _listen(host, port)
        self.port: int = self._listener.getsockname()[1]
        config = uvicorn.Config(
            make_app(desk),
            ssl_certfile=certificate,
            ssl_keyfile=key,
            log_config=None,
            log_level="warning",
            access_log=False,
            lifespan="off",
            timeout_graceful_shutdown=1,
            ws=SocketProtocol,
        )
        self._server = uvicorn.Server(config)
        serve = partial(self._server.run, sockets=[self._listener])
        self._thread = threading.Thread(target=serve, name="desk", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop listening."""
        self._server.should_exit = True
        self._thread.join(_END)
        self._listener.close()


def own_certificate(folder: Path) -> tuple[Path, Path]:
    """Return the files of a certificate and its key; make them if there are none.

    Args:
        folder: Folder of certificate and key.

    Raises:
        DeskCertificateError: There are none, and they cannot be made.
    """
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    if certificate.is_file() and key.is_file():
        return certificate, key
    command = [
        *("openssl", "req", "-x509", "-newkey", "ec"),
        *("-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "3650"),
        *("-subj", "/CN=simulated Franka Desk"),
        *("-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"),
        *("-keyout", str(key), "-out", str(certificate)),
    ]
    try:
        make_private_folder(folder)
        # The key is for the user alone from its first byte on.
        os.close(os.open(key, os.O_CREAT | os.O_WRONLY, 0o600))
        subprocess.run(command, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        told = getattr(error, "stderr", b"") or str(error).encode()
        raise DeskCertificateError(
            f"Desk has no certificate in {folder}, and none can be made: "
            f"{told.decode(errors='replace').strip()}",
            remedy="Install openssl, or put certificate.pem and key.pem there.",
        ) from error
    return certificate, key


def _listen(host: str, port: int) -> socket.socket:
    try:
        return socket.create_server((host, port))
    except OSError as error:
        remedy = "End what listens there, or choose another --host, e.g. 127.0.0.2."
        if isinstance(error, PermissionError) and port < FIRST_FREE_PORT:
            remedy = (
                "Ports below 1024 need a permission: sudo sysctl -w "
                f"net.ipv4.ip_unprivileged_port_start={port}. Or choose another port, "
                "--desk 8443, for clients that take `127.0.0.1:8443` as the robot's "
                "address in Desk; most take the address alone and need 443."
            )
        # `create_server` adds the address.
        reason = str(error.strerror).partition(" (while")[0]
        raise FciPortError(
            f"Desk cannot be served at {host}:{port}: {reason}.", remedy=remedy
        ) from error
