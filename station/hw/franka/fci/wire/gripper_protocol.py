"""The messages between libfranka and a hand, as tables.

Source: libfranka-common@e6aa0fc include/research_interface/gripper/types.h.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from station.hw.franka.fci.wire.robot_protocol import ConnectStatus, Exchange
from station.hw.franka.fci.wire.structure import Field, Structure

GRIPPER_HEADER = Structure([("command", "H"), ("command_id", "I"), ("size", "I")])
"""Head of every TCP message to and from a hand."""


class HandCommand(IntEnum):
    """The commands of a hand, with their numbers on the wire."""

    CONNECT = 0
    HOMING = 1
    GRASP = 2
    MOVE = 3
    STOP = 4


class GripperStatus(IntEnum):
    """Answers to every command of a hand, except `CONNECT`."""

    SUCCESS = 0
    FAIL = 1
    UNSUCCESSFUL = 2
    ABORTED = 3


@dataclass(frozen=True, slots=True)
class GripperProtocol:
    """One version of the protocol of a hand, like `RobotProtocol` for an arm.

    Attributes:
        version: Number that a client names when it connects.
        port: TCP port of the server.
        exchanges: Request and answer of every command.
        state: Structure of the hand's states.
    """

    version: int
    port: int
    exchanges: Mapping[HandCommand, Exchange]
    state: Structure


_EXCHANGES: dict[HandCommand, tuple[list[Field], list[Field]]] = {
    HandCommand.CONNECT: ([("version", "H"), ("udp_port", "H")], [("version", "H")]),
    HandCommand.HOMING: ([], []),
    HandCommand.GRASP: (
        [
            ("width", "d"),
            ("epsilon_inner", "d"),
            ("epsilon_outer", "d"),
            ("speed", "d"),
            ("force", "d"),
        ],
        [],
    ),
    HandCommand.MOVE: ([("width", "d"), ("speed", "d")], []),
    HandCommand.STOP: ([], []),
}

_CONNECT = HandCommand.CONNECT

HAND = GripperProtocol(
    version=3,
    port=1338,
    exchanges={
        command: Exchange(
            Structure(request),
            Structure([("status", "H"), *answer]),
            command,
            tuple(ConnectStatus if command is _CONNECT else GripperStatus),
        )
        for command, (request, answer) in _EXCHANGES.items()
    },
    state=Structure([
        ("message_id", "I"),
        ("width", "d"),
        ("max_width", "d"),
        ("is_grasped", "?"),
        ("temperature", "H"),
    ]),
)
"""Version 3, which the hands of the Panda speak."""
