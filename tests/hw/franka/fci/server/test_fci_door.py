"""The process that moves bytes between clients and a station; here it is a thread."""

import os
import socket
import threading

import pytest

from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.fci_door import (
    ANSWER,
    DATA,
    LEAVE,
    MEMORY_BYTES,
    OF_HAND,
    OPEN,
    REFUSAL,
    UDP_PORT,
    FciDoor,
    StationGoneError,
    receive_frame,
    refusal,
    relay,
    send_frame,
)
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import PANDA
from tests.hw.franka.fci.server.server_bench import HOST
from tests.waiting import PATIENCE


class Door:
    """A door in a thread, and the station's ends of its pipe and its page."""

    def __init__(self):
        memory = bytearray(MEMORY_BYTES)
        self.station, pipe = socket.socketpair()
        self.station.settimeout(PATIENCE)
        self.page, self._pipe = SharedPage(memory), pipe
        self.hand_page = SharedPage(memory, PAGE_BYTES)
        hand = SharedPage(memory, PAGE_BYTES)
        door = FciDoor(HOST, pipe, SharedPage(memory), hand)
        self._thread = threading.Thread(target=door.run)
        self._thread.start()

    def expect(self, kind, answer=b"", port=0):
        """Wait for a frame, and answer it."""
        found, data = receive_frame(self.station)
        assert found == kind
        send_frame(self.station, ANSWER, UDP_PORT.pack(port) + answer)
        return data

    def expect_any(self):
        """Wait for a frame, and answer it; return its kind."""
        found, _ = receive_frame(self.station)
        send_frame(self.station, ANSWER, UDP_PORT.pack(0))
        return found

    def close(self):
        """End the door, as a station that goes does."""
        self.station.shutdown(socket.SHUT_WR)
        self._thread.join(PATIENCE)
        assert not self._thread.is_alive()
        self._pipe.close()
        self.station.close()


def connect_again():
    """Connect after a client has left: the door listens again a moment later."""
    for _ in range(100_000):
        try:
            return socket.create_connection((HOST, PANDA.port), 5.0)
        except ConnectionRefusedError:
            os.sched_yield()
    raise AssertionError("the door does not listen again")


@pytest.fixture
def door():
    opened = Door()
    yield opened
    opened.close()


@pytest.fixture
def client():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("0.0.0.0", 0))  # as libfranka does
        udp.settimeout(PATIENCE)
        yield udp


def test_bytes_of_a_client_go_through_and_answers_come_back(door):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        door.expect(OPEN)
        tcp.sendall(b"request")
        assert door.expect(DATA, b"answer") == b"request"
        assert tcp.recv(100) == b"answer"
        door.page.put_answers(b"later")
        assert tcp.recv(100) == b"later"
    door.expect(LEAVE)


def test_answers_never_overtake_the_state_that_they_were_left_behind():
    sent = []

    class Port:
        datagrams = list

        def send(self, data):
            sent.append(bytes(data))

        def send_datagram(self, data):
            sent.append(data[:1])

    memory = bytearray(MEMORY_BYTES)
    control, door = SharedPage(memory), SharedPage(memory)
    control.put_state(b"s" * PANDA.state.size)
    control.put_answers(b"answer")
    relay(Port(), door)
    assert sent == [b"s", b"answer"]


def test_states_and_commands_go_through_the_shared_memory(door, client):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        door.expect(OPEN)
        tcp.sendall(b"connect")
        port = client.getsockname()[1]
        door.expect(DATA, b"connected", port)
        assert tcp.recv(100) == b"connected"
        door.page.put_state(bytearray(b"s" * PANDA.state.size))
        state, server = client.recvfrom(4096)
        assert state == b"s" * PANDA.state.size

        command = b"c" * PANDA.command.size
        client.sendto(command, server)
        tcp.sendall(b"next")  # a turn of the door later than the command
        door.expect(DATA, port=port)
        tcp.sendall(b"next")
        door.expect(DATA, port=port)
        assert door.page.take_command() == command
    door.expect(LEAVE)


def test_client_of_the_hand_is_served_beside_the_one_of_the_arm(door, client):
    with (
        socket.create_connection((HOST, PANDA.port), 5.0),
        socket.create_connection((HOST, HAND.port), 5.0) as tcp,
    ):
        assert {door.expect_any(), door.expect_any()} == {OPEN, OPEN + OF_HAND}
        tcp.sendall(b"request")
        port = client.getsockname()[1]
        assert door.expect(DATA + OF_HAND, b"answer", port) == b"request"
        assert tcp.recv(100) == b"answer"
        door.page.put_answers(b"for the arm")
        door.hand_page.put_answers(b"later")
        assert tcp.recv(100) == b"later"
        door.hand_page.put_state(b"s" * HAND.state.size)
        assert client.recv(4096) == b"s" * HAND.state.size
    assert {door.expect_any(), door.expect_any()} == {LEAVE, LEAVE + OF_HAND}


def test_hand_whose_address_is_taken_is_told_and_the_arm_let_go():
    with socket.create_server((HOST, HAND.port)):
        one, other = socket.socketpair()
        pages = [SharedPage(bytearray(PAGE_BYTES)) for _ in range(2)]
        with one, other, pytest.raises(FciPortError, match="Gripper cannot be served"):
            FciDoor(HOST, one, *pages)
        with socket.create_server((HOST, PANDA.port)):
            pass


def test_client_that_the_station_refuses_is_sent_away(door):
    with socket.create_connection((HOST, PANDA.port), 5.0) as tcp:
        door.expect(OPEN)
        tcp.sendall(b"nonsense")
        receive_frame(door.station)
        send_frame(door.station, REFUSAL, refusal("no command", b"last words"))
        door.expect(LEAVE)
        assert tcp.recv(100) == b"last words"
        assert tcp.recv(100) == b""
    with connect_again():
        door.expect(OPEN)
    door.expect(LEAVE)


def test_address_that_is_taken_is_told():
    with socket.create_server((HOST, PANDA.port)):
        one, other = socket.socketpair()
        with one, other, pytest.raises(FciPortError, match=HOST):
            FciDoor(HOST, one, SharedPage(bytearray(PAGE_BYTES)))


def test_end_of_the_other_side_is_told():
    one, other = socket.socketpair()
    other.close()
    with one, pytest.raises(StationGoneError):
        receive_frame(one)
