"""The driver's sockets, over loopback."""

import socket

import pytest

from station.hw.franka.fci.driver.network import SLICE, FciNetwork, FciNetworkError
from tests.hw.franka.fci.server.server_bench import HOST
from tests.waiting import PATIENCE


@pytest.fixture
def listener():
    with socket.create_server((HOST, 0)) as opened:
        yield opened


@pytest.fixture
def joined(listener):
    """Yield the network and the robot's end of its connection."""
    network = FciNetwork(*listener.getsockname())
    robot = listener.accept()[0]
    yield network, robot
    network.close()
    robot.close()


@pytest.fixture
def robot_udp():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.bind((HOST, 0))
        opened.settimeout(PATIENCE)
        yield opened


def test_port_without_fci_is_told_in_libfrankas_words(listener):
    address = listener.getsockname()
    listener.close()
    with pytest.raises(FciNetworkError, match="Connection to FCI refused") as error:
        FciNetwork(*address)
    assert "robot_ip" in error.value.remedy


def test_name_that_nobody_has_is_told():
    with pytest.raises(FciNetworkError, match=r"Connection error at nobody\.invalid"):
        FciNetwork("nobody.invalid", 1337)


def test_wait_without_a_datagram_ends_after_a_slice(joined):
    network, _ = joined
    assert SLICE < 0.02
    assert network.wait(bytearray(10)) == 0
    assert network.poll(bytearray(10)) == 0


def test_datagrams_go_to_where_the_first_state_came_from(joined, robot_udp):
    network, _ = joined
    robot_udp.sendto(b"state", (HOST, network.udp_port))
    buffer = bytearray(10)
    assert network.wait(buffer) == 5
    assert buffer[:5] == b"state"

    network.send_datagram(bytearray(b"command"))
    assert robot_udp.recv(100) == b"command"


def test_datagram_of_a_stranger_is_passed_over(joined, robot_udp):
    network, _ = joined
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 0))
        stranger.sendto(b"forged", ("127.0.0.1", network.udp_port))
    assert network.wait(bytearray(10)) == 0
    robot_udp.sendto(b"state", (HOST, network.udp_port))
    assert network.wait(bytearray(10)) == 5


def test_closed_connection_is_told(joined):
    network, robot = joined
    assert network.receive(0.0) == b""
    robot.sendall(b"answer")
    assert network.receive(1.0) == b"answer"
    robot.close()
    with pytest.raises(FciNetworkError, match="server closed connection") as caught:
        network.receive(1.0)
    assert "End other programs" in caught.value.remedy
