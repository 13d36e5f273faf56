"""The messages between libfranka and a hand, as tables.

Source: libfranka-common@e6aa0fc include/research_interface/gripper/types.h.
"""

from enum import IntEnum

from station.hw.franka.fci.wire.robot_protocol import (
    ConnectStatus,
    Exchange,
    FciProtocol,
)
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

HAND = FciProtocol(
    device="hand",
    version=3,
    port=1338,
    header=GRIPPER_HEADER,
    connect=_CONNECT,
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
    command=Structure(()),
)
"""Version 3, which the hands of the Panda speak."""
