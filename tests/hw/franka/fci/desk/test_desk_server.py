"""Desk's certificate and port, and what its changes do to the arm that is served."""

import hashlib
import os
import socket
import ssl
import stat
import subprocess

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import RobotMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.fci.desk.desk_server import (
    DeskCertificateError,
    DeskServer,
    own_certificate,
)
from station.hw.franka.fci.desk.desk_state import Desk, profile_of
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import PANDA, Command, Status
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from tests.hw.franka.fci.server.robot_client import request, statuses
from tests.waiting import PATIENCE

HOST = f"127.19.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


def test_certificate_is_made_once_for_the_user_alone(tmp_path):
    folder = tmp_path / "desk"
    certificate, key = own_certificate(folder)
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    before = certificate.read_bytes()
    assert own_certificate(folder) == (certificate, key)
    assert certificate.read_bytes() == before


def test_fingerprint_is_that_of_the_certificate_that_is_shown(desk, folder):
    server = DeskServer(desk, "127.0.0.1", 0, folder)
    try:
        shown = ssl.get_server_certificate(("127.0.0.1", server.port), timeout=5.0)
    finally:
        server.close()
    der = ssl.PEM_cert_to_DER_cert(shown)
    assert hashlib.sha256(der).hexdigest() == server.fingerprint


def test_missing_openssl_is_told(tmp_path, monkeypatch):
    def run(*_command, **_options):
        raise FileNotFoundError("no openssl")

    monkeypatch.setattr(subprocess, "run", run)
    with pytest.raises(DeskCertificateError, match="no openssl") as refused:
        own_certificate(tmp_path)
    assert "Install openssl" in refused.value.remedy


def test_port_that_is_taken_or_not_permitted_is_told(desk, folder, monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(FciPortError, match=f"127.0.0.1:{port}") as refused:
            DeskServer(desk, "127.0.0.1", port, folder)
        assert "End what listens there" in refused.value.remedy

    def refuse(*_address):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(socket.socket, "bind", refuse)
    with pytest.raises(FciPortError, match="Permission denied") as refused:
        DeskServer(desk, "127.0.0.1", 443, folder)
    assert "ip_unprivileged_port_start=443" in refused.value.remedy


class Served:
    """A simulated arm that is served with a Desk, whose cycles the test makes."""

    def __init__(self):
        files = load_robot_files("example-robot-data:panda")
        self.arm = simulate([ArmPlacement("panda", files)]).arms["panda"]
        self.server = FciServer(self.arm, None, FciSettings(HOST), ClientFeatures())
        self.desk = Desk(self.server, self.arm, None, "panda")
        self.desk.reboot()

    def run(self, cycles=3):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)

    def connect(self):
        """Return a client's socket that has connected."""
        client = socket.create_connection((HOST, PANDA.port), timeout=PATIENCE)
        self.ask(client, Command.CONNECT, {"version": 5, "udp_port": 4711})
        return client

    def ask(self, client, command, values):
        client.sendall(request(command, 1, values))
        self.run(5)
        (found,) = statuses(client.recv(4096))
        return found


@pytest.fixture
def served():
    made = Served()
    yield made
    made.server.close()


def test_fci_that_is_off_refuses_connections_and_sends_clients_away(served):
    served.run()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((HOST, PANDA.port), timeout=PATIENCE)
    done = served.desk.set_fci(active=True)
    served.run()
    assert done.done()
    with served.connect() as client:
        served.desk.set_fci(active=False)
        served.run()
        assert client.recv(1) == b""
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((HOST, PANDA.port), timeout=PATIENCE)


def test_closed_brakes_refuse_motions_and_end_them(served):
    move = {"controller_mode": 0, "motion_generator_mode": 0}
    served.desk.set_fci(active=True)
    served.run()
    assert served.arm.state.robot_mode is RobotMode.OTHER
    with served.connect() as client:
        refused = served.ask(client, Command.MOVE, move)
        assert refused == Status.COMMAND_NOT_POSSIBLE_REJECTED
        served.desk.set_brakes(closed=False)
        served.run()
        assert served.arm.state.robot_mode is RobotMode.IDLE
        assert served.ask(client, Command.MOVE, move) == Status.MOTION_STARTED
        served.desk.set_brakes(closed=True)
        served.run()
        assert statuses(client.recv(4096)) == [Status.ABORTED]
    assert served.arm.state.robot_mode is RobotMode.OTHER


@pytest.mark.parametrize("toggle", [False, True])
def test_opening_the_brakes_ends_a_reflex(served, toggle):
    served.desk.set_brakes(closed=False)
    served.run()
    served.arm.simulation().apply_force("panda_hand", [0, 0, -90.0], [0, 0, 0], 0.05)
    served.run(60)
    assert served.arm.state.robot_mode is RobotMode.REFLEX
    if toggle:
        served.desk.set_brakes(closed=True)
    served.desk.set_brakes(closed=False)
    served.run(600)
    assert served.arm.state.robot_mode is RobotMode.IDLE


def test_end_effector_shows_in_the_state_and_the_arm_carries_what_it_has(served):
    arm, before = served.arm, [*served.arm.state.q]
    frame = (*IDENTITY[:14], 0.2, 1.0)
    load = RigidBody(0.4, (0.0, 0.0, 0.1), (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01))
    served.desk.profiles["pen"] = profile_of("pen", load, frame)
    served.desk.activate_profile("pen")
    served.run(50)
    assert arm.state.m_ee == 0.4
    assert [*arm.state.F_T_NE] == pytest.approx(frame)
    assert [*arm.state.q] == pytest.approx(before, abs=1e-3)


def test_change_that_fails_is_told_to_its_caller(served):
    def fail():
        raise OSError("taken")

    done = served.server.change(fail)
    served.run()
    assert isinstance(done.exception(), OSError)
