"""A server with a plain arm behind it, and sockets of clients.

Client and server are in one thread: bytes lie in the kernel until the server runs for
some cycles.
"""

import os
import socket

from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import (
    PANDA,
    Command,
    MoveController,
    MoveGenerator,
)
from tests.hw.franka.fci.server.robot_client import answers, request
from tests.hw.franka.scripted_arm import ScriptedArm
from tests.waiting import PATIENCE

# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.18.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"
ROBOT = (HOST, PANDA.port)


class Bench:
    """A server with a plain arm, and the sockets of clients."""

    def __init__(self, patience=0.0):
        self.arm = ScriptedArm()
        self.server = FciServer(
            self.arm, None, FciSettings(HOST, patience), ClientFeatures()
        )
        self.sockets = []

    def run(self, cycles=5):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)

    def open(self):
        """Return a TCP and a UDP socket of a new client, the former connected."""
        tcp = socket.create_connection(ROBOT, timeout=PATIENCE)
        udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sockets += [tcp, udp]
        udp.bind(("0.0.0.0", 0))  # as libfranka does
        udp.settimeout(PATIENCE)
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
