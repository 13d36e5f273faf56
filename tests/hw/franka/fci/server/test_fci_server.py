"""The server's sockets: one client, broken connections, and what does not disturb it.

Client and server are in one thread: bytes lie in the kernel until the server runs for
some cycles.
"""

import contextlib
import os
import socket

import pytest

from station.core.franka import RobotMode
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    PANDA,
    Command,
    MoveController,
    MoveGenerator,
)
from tests.hw.franka.fci.server.robot_client import answers, request
from tests.hw.franka.scripted_arm import ScriptedArm

# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.18.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"
ROBOT = (HOST, PANDA.port)


class Bench:
    """A server with a plain arm, and the sockets of clients."""

    def __init__(self, patience=0.0):
        self.arm = ScriptedArm()
        self.server = FciServer(
            self.arm, None, FciSettings(HOST, patience), lambda _a, _s: None
        )
        self.sockets = []

    def run(self, cycles=5):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)

    def open(self):
        """Return a TCP and a UDP socket of a new client, the former connected."""
        tcp = socket.create_connection(ROBOT, timeout=1.0)
        udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sockets += [tcp, udp]
        udp.bind(("0.0.0.0", 0))  # as libfranka does
        udp.settimeout(1.0)
        self.run()
        return tcp, udp

    def connect(self):
        tcp, udp = self.open()
        port = udp.getsockname()[1]
        tcp.sendall(request(Command.CONNECT, 1, {"version": 5, "udp_port": port}))
        self.run()
        assert answers(tcp.recv(100))[0][2]["status"] == 0
        return tcp, udp

    def move(self, tcp):
        """Begin a motion with positions."""
        modes = {
            "controller_mode": MoveController.JOINT_IMPEDANCE,
            "motion_generator_mode": MoveGenerator.JOINT_POSITION,
        }
        tcp.sendall(request(Command.MOVE, 2, modes))
        self.run()
        assert answers(tcp.recv(100))[0][2]["status"] == 1

    def close(self):
        self.server.close()
        for one in self.sockets:
            one.close()


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


def newest(udp):
    """Return the newest state and the server's address."""
    udp.settimeout(0.0)
    found = None
    while True:
        try:
            found = udp.recvfrom(4096)
        except BlockingIOError:
            return PANDA.state.unpack(found[0]), found[1]


def command(message_id, q):
    return PANDA.command.pack({"message_id": message_id, "q_c": q})


def test_a_state_arrives_every_cycle_with_the_next_number(bench):
    _, udp = bench.connect()
    bench.run(20)
    ids = [PANDA.state.unpack(udp.recv(4096))["message_id"] for _ in range(20)]
    assert ids == list(range(ids[0], ids[0] + 20))


def test_second_client_is_refused_until_the_first_has_gone(bench):
    tcp, _ = bench.connect()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(ROBOT, timeout=1.0)
    tcp.close()
    bench.run()
    bench.connect()


@pytest.mark.parametrize("size", [1, 11, 12, 15])
def test_client_that_goes_within_a_message_disturbs_nobody(bench, size):
    tcp, _ = bench.open()
    tcp.sendall(request(Command.CONNECT, 1, {"version": 5})[:size])
    bench.run()
    tcp.close()
    bench.run()
    bench.connect()


@pytest.mark.parametrize(
    "data",
    [
        HEADER.pack({"command": 77, "size": 12}),
        HEADER.pack({"command": Command.CONNECT, "size": 12}),
        request(Command.STOP_MOVE, 1),
    ],
    ids=["unknown command", "wrong size", "not connected"],
)
def test_client_that_breaks_the_protocol_is_hung_up_on(bench, data):
    tcp, _ = bench.open()
    tcp.sendall(data)
    bench.run()
    with contextlib.suppress(ConnectionResetError):
        assert tcp.recv(100) == b""
    bench.connect()


def test_connection_that_breaks_in_a_motion_stops_the_arm(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    udp.sendto(command(state["message_id"], state["q_d"]), server)
    bench.run(2)
    assert bench.arm.state.robot_mode is RobotMode.MOVE
    tcp.close()
    bench.run(2)
    assert bench.arm.state.robot_mode is RobotMode.IDLE
    tcp, _ = bench.connect()
    bench.move(tcp)


def test_commands_count_once_and_missing_ones_are_lost(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    udp.sendto(command(state["message_id"], state["q_d"]), server)
    bench.run(4)
    counts = bench.server.counts
    assert (counts.commanded, counts.lost) == (4, 3)


def test_the_arms_time_waits_for_a_late_command_as_long_as_it_is_told():
    bench = Bench(patience=0.02)
    try:
        tcp, udp = bench.connect()
        bench.move(tcp)
        state, server = newest(udp)
        udp.sendto(command(state["message_id"], state["q_d"]), server)
        bench.run(1)
        started = bench.server._clock()
        bench.run(2)
        assert bench.server._clock() - started >= 0.04
        assert bench.server.counts.lost == 2
    finally:
        bench.close()


def test_commands_from_elsewhere_are_no_commands(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.18.251.251", 0))
        stranger.sendto(command(state["message_id"], [0.5] * 7), server)
        bench.run()
    assert bench.arm.sent == []


def test_client_that_does_not_listen_disturbs_nobody(bench):
    tcp, udp = bench.connect()
    udp.close()
    bench.run(10)
    tcp.sendall(request(Command.STOP_MOVE, 3))
    bench.run()
    assert answers(tcp.recv(100)) == [(Command.STOP_MOVE, 3, {"status": 0})]


def test_address_that_is_taken_is_told(bench):
    with pytest.raises(FciPortError, match="1337: Address already in use"):
        Bench()
    tcp, _ = bench.connect()
    tcp.close()
