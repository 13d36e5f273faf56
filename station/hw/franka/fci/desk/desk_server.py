"""Desk on a port of its own, with TLS and a certificate of its own.

The requests are answered in a thread; what they change of the arm is done by the
server of libfranka's programs between two of its cycles.
"""

import hashlib
import os
import socket
import ssl
import subprocess
import threading
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from pathlib import Path
from typing import Protocol

import uvicorn

from station.core.errors import StationError
from station.core.user_files import make_private_folder, user_folder
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.load import Load
from station.hw.franka.fci.desk.desk_routes import make_app
from station.hw.franka.fci.desk.desk_state import (
    MOUNTED,
    NO_END_EFFECTOR,
    Desk,
    profile_of,
)
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.simulated_arm import SimulatedArm

HTTPS = 443
"""Port of Desk: clients that take the address of the robot alone use no other one."""
FIRST_FREE_PORT = 1024
DAYS = 3650
"""Validity of a certificate [days]."""
_END = 5.0


class DeskCertificateError(StationError):
    """There is no certificate with which Desk could be served."""

    code = "desk_certificate"


class ServerOfDesk(Protocol):
    """A server of libfranka's programs, as Desk needs it. Any thread."""

    def change(self, action: Callable[[], None]) -> Future[None]:
        """Let something be done between two cycles of the arm."""

    def open_or_close(self, *, is_open: bool) -> Future[None]:
        """Let programs of libfranka connect, or send them away and refuse them."""


class ServedArm:
    """Desk's way to the arm that a server serves; see `DeskArm`. Any thread.

    Args:
        server: The server.
        arm: The arm.
        hand: The hand; None without a hand.
        kind: Kind of arm, as Desk calls it.
    """

    def __init__(
        self,
        server: ServerOfDesk,
        arm: SimulatedArm,
        hand: HandServices | None,
        kind: str,
    ) -> None:
        self._server, self._arm, self._hand = server, arm, hand
        self.kind = kind

    def set_brakes(self, *, closed: bool) -> Future[None]:
        """Close or open the brakes."""
        set_brakes = self._arm.simulation().set_brakes
        return self._server.change(partial(set_brakes, closed=closed))

    def set_fci(self, *, active: bool) -> Future[None]:
        """Let programs of libfranka connect, or not."""
        return self._server.open_or_close(is_open=active)

    def set_end_effector(self, load: Load, frame: tuple[float, ...]) -> Future[None]:
        """Let the state tell of another end effector."""
        return self._server.change(partial(self._arm.set_mounted, load, frame))

    def home_gripper(self) -> Future[None]:
        """Begin the homing of the hand, if there is one."""
        return self._server.change(self._home)

    def joints(self) -> list[float]:
        """Return the positions of the joints [rad], shape (7,)."""
        return [*self._arm.state.q]

    def mounted(self) -> tuple[Load, tuple[float, ...]]:
        """Return the end effector that the state tells of, and F_T_NE."""
        state = self._arm.state
        load = Load(state.m_ee, (*state.F_x_Cee,), (*state.I_ee,))
        return load, (*state.F_T_NE,)

    def _home(self) -> None:
        if self._hand is not None:
            self._hand.homing()


def new_desk(arm: ServedArm, *, is_ready: bool = False) -> Desk:
    """Return a Desk with the end effector that is mounted.

    Args:
        arm: The arm.
        is_ready: Whether the brakes are open and FCI is active already; else the brakes
            are closed and FCI is off.
    """
    desk = Desk(
        arm,
        {
            MOUNTED: profile_of("Mounted", *arm.mounted()),
            NO_END_EFFECTOR: profile_of("No End Effector", Load(), IDENTITY),
        },
    )
    if is_ready:
        desk.are_brakes_closed, desk.is_fci_active = False, True
    else:
        desk.reboot()
    return desk


class DeskServer:
    """Serves a Desk until it is closed.

    Args:
        desk: The Desk.
        host: Address to listen at.
        port: TCP port.
        folder: Where the certificate is kept; the user's own folder if None.

    Attributes:
        fingerprint: SHA-256 of the certificate, as hexadecimal digits.

    Raises:
        FciPortError: The port cannot be used.
        DeskCertificateError: There is no certificate, and none can be made.
    """

    def __init__(
        self, desk: Desk, host: str, port: int = HTTPS, folder: Path | None = None
    ) -> None:
        certificate, key = own_certificate(folder or user_folder("desk"))
        der = ssl.PEM_cert_to_DER_cert(certificate.read_text(encoding="ascii"))
        self.fingerprint = hashlib.sha256(der).hexdigest()
        self._listener = _listen(host, port)
        config = uvicorn.Config(
            make_app(desk),
            ssl_certfile=certificate,
            ssl_keyfile=key,
            log_config=None,
            log_level="warning",
            access_log=False,
            lifespan="off",
            timeout_graceful_shutdown=1,
            ws="websockets-sansio",
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._run, name="desk", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """TCP port."""
        number: int = self._listener.getsockname()[1]
        return number

    def close(self) -> None:
        """Listen no longer."""
        self._server.should_exit = True
        self._thread.join(_END)
        self._listener.close()

    def _run(self) -> None:
        self._server.run(sockets=[self._listener])


def own_certificate(folder: Path) -> tuple[Path, Path]:
    """Return the files of a certificate and its key; make them if there are none.

    Args:
        folder: Where they are kept.

    Raises:
        DeskCertificateError: There are none, and they cannot be made.
    """
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    if certificate.is_file() and key.is_file():
        return certificate, key
    command = [
        *("openssl", "req", "-x509", "-newkey", "ec"),
        *("-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", str(DAYS)),
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
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen()
    except OSError as error:
        listener.close()
        remedy = "End what listens there, or choose another --host, e.g. 127.0.0.2."
        if isinstance(error, PermissionError) and port < FIRST_FREE_PORT:
            remedy = (
                "Ports below 1024 need a permission: sudo sysctl -w "
                f"net.ipv4.ip_unprivileged_port_start={port}. Or choose another port, "
                "--desk 8443, for clients that take `127.0.0.1:8443` as the robot's "
                "address in Desk; most take the address alone and need 443."
            )
        raise FciPortError(
            f"Desk cannot be served at {host}:{port}: {error.strerror}.", remedy=remedy
        ) from error
    return listener
