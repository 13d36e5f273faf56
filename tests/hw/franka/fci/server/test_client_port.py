"""The port of a client: one at a time, broken connections, what does not disturb."""

import contextlib
import socket

import pytest

from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.wire.robot_protocol import HEADER, Command
from tests.hw.franka.fci.server.robot_client import answers, request
from tests.hw.franka.fci.server.server_bench import (
    HOST,
    ROBOT,
    Bench,
    command,
    newest,
)
from tests.waiting import PATIENCE


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


def test_second_client_is_hung_up_on_and_the_first_goes_on(bench):
    tcp, _ = bench.connect()
    with socket.create_connection(ROBOT, timeout=PATIENCE) as second:
        bench.run()
        assert second.recv(1) == b""
    tcp.sendall(request(Command.STOP_MOVE, 3))
    bench.run()
    assert answers(tcp.recv(100)) == [(Command.STOP_MOVE, 3, {"status": 0})]


def test_client_can_connect_as_soon_as_the_one_before_has_closed(bench):
    for _ in range(3):
        tcp, _ = bench.connect()
        tcp.close()
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


def test_commands_from_elsewhere_are_no_commands(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.18.251.251", 0))
        stranger.sendto(command(state["message_id"], [0.5] * 7), server)
        bench.run()
    assert bench.arm.sent == []


def test_commands_of_another_program_of_the_client_are_no_commands(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    order = command(state["message_id"], [0.5] * 7)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind((HOST, 0))
        stranger.sendto(order, server)
        bench.run()
    assert bench.arm.sent == []
    udp.sendto(order, server)
    bench.run()
    assert bench.arm.sent


def test_client_of_another_version_can_connect_as_soon_as_it_has_the_answer(
    bench, caplog
):
    for version in (10, 4):
        tcp, _ = bench.open()
        tcp.sendall(request(Command.CONNECT, 1, {"version": version}))
        bench.run()
        # The client has closed nothing when it tries again.
        with socket.create_connection(ROBOT, timeout=PATIENCE):
            assert answers(tcp.recv(100)) == [
                (Command.CONNECT, 1, {"status": 1, "version": 5})
            ]
            bench.run()
        assert f"asked for version {version} of the arm's protocol" in caplog.text
        bench.run()
    bench.connect()


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


def test_client_with_a_udp_port_that_cannot_be_disturbs_nobody(bench):
    tcp, _ = bench.open()
    tcp.sendall(request(Command.CONNECT, 1, {"version": 5, "udp_port": 0}))
    bench.run(10)
    tcp.sendall(request(Command.STOP_MOVE, 3))
    bench.run()
    assert len(answers(tcp.recv(100))) == 2
