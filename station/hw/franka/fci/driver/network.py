"""The sockets between this side and an arm: TCP for requests, UDP for the cycle.

Source: libfranka@0.9.2 src/network.cpp, Network, also for the words of its errors.
"""

import socket
import struct

from station.core.errors import StationError
from station.local.descriptors import wait_until_readable

TCP_TIMEOUT = 1.0
"""Longest wait for a connection and for the answer to a request [s]."""
UDP_TIMEOUT = 1.0
"""Time without a state after which the arm is lost [s]. Source: libfranka@0.9.2
src/network.h, Network."""
SLICE = 0.005
"""Longest wait for a state [s]: other work of the control thread waits no longer."""
_CHUNK = 65_536
_OTHERS = "End other programs that use the arm or its hand."
_TIMEVAL = struct.Struct("@ll")


class FciNetworkError(StationError, OSError):
    """The arm cannot be reached, or can no longer be reached."""

    code = "fci_network"


class FciNetwork:
    """Connects to an arm.

    `wait` is one blocking call of the operating system, which releases the interpreter
    lock while it sleeps; so does `send_datagram`, which does not sleep.

    Args:
        host: Address of the arm.
        port: Its TCP port.
        is_strict: Whether states from another address than the arm's are dropped.

    Attributes:
        udp_port: Port on which states arrive.
        sender: The address from which states come; empty until one has come.

    Raises:
        FciNetworkError: No answer comes, or no answer of FCI.
    """

    def __init__(self, host: str, port: int, *, is_strict: bool = True) -> None:
        self._is_strict, self.sender = is_strict, ""
        self._tcp = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._is_connected = False
        try:
            self._connect(host, port)
        except OSError as error:
            self.close()
            raise _explain(error, host, port) from error
        self.udp_port: int = self._udp.getsockname()[1]

    def _connect(self, host: str, port: int) -> None:
        tcp, udp = self._tcp, self._udp
        tcp.settimeout(TCP_TIMEOUT)
        tcp.connect((host, port))
        tcp.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._peer: str = tcp.getpeername()[0]
        udp.bind(("0.0.0.0", 0))
        # A receive that times out in the kernel is one call; settimeout makes it two.
        timeout = _TIMEVAL.pack(0, round(SLICE * 1e6))
        udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, timeout)

    def fileno(self) -> int:
        """Return the descriptor of the TCP stream, to wait for."""
        return self._tcp.fileno()

    def send(self, data: bytes) -> None:
        """Send bytes of the TCP stream.

        Raises:
            FciNetworkError: The connection is broken.
        """
        try:
            self._tcp.sendall(data)
        except OSError as error:
            raise FciNetworkError(f"libfranka: TCP send bytes: {error}") from error

    def receive(self, timeout: float) -> bytes:
        """Return the next bytes of the TCP stream; empty if none come in time.

        Args:
            timeout: How long to wait [s]; 0 looks once.

        Raises:
            FciNetworkError: The connection is broken.
        """
        try:
            if not wait_until_readable([self._tcp.fileno()], timeout):
                return b""
            data = self._tcp.recv(_CHUNK)
        except OSError as error:
            raise FciNetworkError(f"libfranka: TCP receive: {error}") from error
        if not data:
            raise FciNetworkError("libfranka: server closed connection", remedy=_OTHERS)
        return data

    def send_datagram(self, data: bytearray) -> None:
        """Send a command; a datagram that the network does not take is lost."""
        try:
            self._udp.send(data, socket.MSG_DONTWAIT)
        except OSError:
            # The arm counts a command that is missing; there is nothing else to do.
            return

    def wait(self, buffer: bytearray) -> int:
        """Wait for a datagram, `SLICE` at most; return its size, 0 without one."""
        return self._take(buffer, 0)

    def poll(self, buffer: bytearray) -> int:
        """Take a datagram that is there already; return its size, 0 without one."""
        return self._take(buffer, socket.MSG_DONTWAIT)

    def _take(self, buffer: bytearray, flags: int) -> int:
        udp = self._udp
        try:
            if self._is_connected:
                return udp.recv_into(buffer, 0, flags)
            size, address = udp.recvfrom_into(buffer, 0, flags)
            if self._is_strict and address[0] != self._peer:
                return 0
            # From now on the kernel drops datagrams of others, and knows the receiver.
            udp.connect(address)
            self.sender = address[0]
        except OSError:
            return 0
        self._is_connected = True
        return size

    def close(self) -> None:
        """Close the connection."""
        self._tcp.close()
        self._udp.close()


def _explain(error: OSError, host: str, port: int) -> FciNetworkError:
    where = f"at {host}:{port}"
    if isinstance(error, ConnectionRefusedError):
        return FciNetworkError(
            f"libfranka: Connection to FCI refused {where}. Please install FCI feature "
            "or enable FCI mode in Desk.",
            remedy="Activate FCI in Desk, end other clients of the arm, and check "
            "robot.robot_ip.",
        )
    if isinstance(error, TimeoutError):
        return FciNetworkError(
            f"libfranka: Connection timeout {where}. Please check your network "
            "connection or settings.",
            remedy="Check cable, address and robot.robot_ip; the arm has to be on.",
        )
    return FciNetworkError(
        f"libfranka: Connection error {where}: {error.strerror or error}.",
        remedy="Check robot.robot_ip and the settings of the network.",
    )
