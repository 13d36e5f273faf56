"""The process that moves bytes between clients and a station; here it is a thread."""

import multiprocessing
import socket
import threading

import pytest

from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.fci_process import (
    DATA,
    LEAVE,
    MEMORY_BYTES,
    OPEN,
    FciProcess,
    relay,
)
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import PANDA
from tests.hw.franka.fci.server.server_bench import HOST
from tests.waiting import PATIENCE


class Process:
    """The sockets, in a thread, and the station's ends of their pipe and page."""

    def __init__(self):
        memory = bytearray(MEMORY_BYTES)
        self.station, pipe = multiprocessing.Pipe()
        self.page, self._pipe = SharedPage(memory), pipe
        self.hand_page = SharedPage(memory, PAGE_BYTES)
        hand = SharedPage(memory, PAGE_BYTES)
        process = FciProcess(HOST, pipe, SharedPage(memory), hand)
        self._thread = threading.Thread(target=process.run)
        self._thread.start()

    def receive(self):
        """Wait for a request; return its kind and bytes, and whether it is the hand's.

        Raises:
            TimeoutError: None comes.
        """
        if not self.station.poll(PATIENCE):
            raise TimeoutError("no request")
        is_hand, kind, data = self.station.recv()
        return kind, data, is_hand

    def expect(self, kind, answer=b"", port=None, *, of_hand=False):
        """Wait for a request, and answer it; return its bytes."""
        found, data, is_hand = self.receive()
        assert (found, is_hand) == (kind, of_hand)
        self.station.send((answer, port, ""))
        return data

    def expect_any(self):
        """Wait for a request, and answer it; return kind, and whether of the hand."""
        found, _, is_hand = self.receive()
        self.station.send((b"", None, ""))
        return found, is_hand

    def close(self):
        """End the process, as a station that goes does."""
        self.station.close()
        self._thread.join(PATIENCE)
        assert not self._thread.is_alive()
        self._pipe.close()


@pytest.fixture
def process():
    opened = Process()
    yield opened
    opened.close()


@pytest.fixture
def client():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("0.0.0.0", 0))  # as libfranka does
        udp.settimeout(PATIENCE)
        yield udp


def test_bytes_of_a_client_go_through_and_answers_come_back(process):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        process.expect(OPEN)
        tcp.sendall(b"request")
        assert process.expect(DATA, b"answer") == b"request"
        assert tcp.recv(100) == b"answer"
        process.page.put_answers(b"later")
        assert tcp.recv(100) == b"later"
    process.expect(LEAVE)


def test_answers_never_overtake_the_state_that_they_were_left_behind():
    sent = []

    class Port:
        datagrams = list

        def send(self, data):
            sent.append(bytes(data))

        def send_datagram(self, data):
            sent.append(data[:1])

    memory = bytearray(MEMORY_BYTES)
    control, process = SharedPage(memory), SharedPage(memory)
    control.put_state(b"s" * PANDA.state.size)
    control.put_answers(b"answer")
    relay(Port(), process)
    assert sent == [b"s", b"answer"]


def test_states_and_commands_go_through_the_shared_memory(process, client):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        process.expect(OPEN)
        tcp.sendall(b"connect")
        port = client.getsockname()[1]
        process.expect(DATA, b"connected", port)
        assert tcp.recv(100) == b"connected"
        process.page.put_state(bytearray(b"s" * PANDA.state.size))
        state, server = client.recvfrom(4096)
        assert state == b"s" * PANDA.state.size

        command = b"c" * PANDA.command.size
        client.sendto(command, server)
        tcp.sendall(b"next")  # a turn of the process later than the command
        process.expect(DATA, port=port)
        tcp.sendall(b"next")
        process.expect(DATA, port=port)
        assert process.page.take_command() == command
    process.expect(LEAVE)


def test_client_of_the_hand_is_served_beside_the_one_of_the_arm(process, client):
    with (
        socket.create_connection((HOST, PANDA.port), 5.0),
        socket.create_connection((HOST, HAND.port), 5.0) as tcp,
    ):
        assert {process.expect_any(), process.expect_any()} == {
            (OPEN, False),
            (OPEN, True),
        }
        tcp.sendall(b"request")
        port = client.getsockname()[1]
        assert process.expect(DATA, b"answer", port, of_hand=True) == b"request"
        assert tcp.recv(100) == b"answer"
        process.page.put_answers(b"for the arm")
        process.hand_page.put_answers(b"later")
        assert tcp.recv(100) == b"later"
        process.hand_page.put_state(b"s" * HAND.state.size)
        assert client.recv(4096) == b"s" * HAND.state.size
    assert {process.expect_any(), process.expect_any()} == {
        (LEAVE, False),
        (LEAVE, True),
    }


def test_hand_whose_address_is_taken_is_told_and_the_arm_let_go():
    with socket.create_server((HOST, HAND.port)):
        one, other = multiprocessing.Pipe()
        pages = [SharedPage(bytearray(PAGE_BYTES)) for _ in range(2)]
        with one, other, pytest.raises(FciPortError, match="Gripper cannot be served"):
            FciProcess(HOST, one, *pages)
        with socket.create_server((HOST, PANDA.port)):
            pass


def test_client_that_the_station_refuses_is_sent_away(process):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        process.expect(OPEN)
        tcp.sendall(b"nonsense")
        process.receive()
        process.station.send((b"last words", None, "no command"))
        process.expect(LEAVE)
        assert tcp.recv(100) == b"last words"
        assert tcp.recv(100) == b""
    with socket.create_connection((HOST, PANDA.port), 5.0):
        process.expect(OPEN)
    process.expect(LEAVE)


def test_address_that_is_taken_is_told():
    with socket.create_server((HOST, PANDA.port)):
        one, other = multiprocessing.Pipe()
        with one, other, pytest.raises(FciPortError, match=HOST):
            FciProcess(HOST, one, SharedPage(bytearray(PAGE_BYTES)))


def test_client_of_a_station_whose_loop_has_died_is_sent_away_and_the_next_is_not(
    process,
):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        assert process.receive()[0] == OPEN
        process.station.send((b"", None, "The loop has died."))
        assert tcp.recv(1) == b""
    with socket.create_connection((HOST, PANDA.port), 5.0):
        process.expect(OPEN)
    assert process.receive()[0] == LEAVE
    process.station.send((b"", None, "The loop has died."))
    with socket.create_connection((HOST, PANDA.port), 5.0):
        process.expect(OPEN)
    process.expect(LEAVE)
