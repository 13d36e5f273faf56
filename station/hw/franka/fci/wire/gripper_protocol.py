"""The messages between libfranka and a hand, as tables.

Source: libfranka-common@e6aa0fc include/research_interface/gripper/types.h.
"""

from enum import IntEnum
from functools import partial

from station.hw.franka.fci.wire.robot_protocol import (
    CONNECT_ROW,
    Exchange,
    FciProtocol,
    row,
)
from station.hw.franka.fci.wire.structure import Structure, fields

GRIPPER_HEADER = Structure(fields("H command", "I command_id size"))
"""Head of every TCP message to and from a hand."""


class HandCommand(IntEnum):
    """The commands of a hand, with their numbers on the wire."""

    CONNECT = 0
    HOMING = 1
    GRASP = 2
    MOVE = 3
    STOP = 4


_row = partial(row, statuses="SUCCESS FAIL UNSUCCESSFUL ABORTED")
_ROWS = {
    HandCommand.CONNECT: CONNECT_ROW,
    HandCommand.HOMING: _row(),
    HandCommand.GRASP: _row("d width epsilon_inner epsilon_outer speed force"),
    HandCommand.MOVE: _row("d width speed"),
    HandCommand.STOP: _row(),
}

HAND = FciProtocol(
    device="hand",
    version=3,
    port=1338,
    header=GRIPPER_HEADER,
    connect=HandCommand.CONNECT,
    exchanges={
        command: Exchange(
            Structure(request),
            Structure([("status", "H"), *answer]),
            command,
            statuses,
        )
        for command, (request, answer, statuses) in _ROWS.items()
    },
    state=Structure(
        fields("I message_id", "d width max_width", "? is_grasped", "H temperature")
    ),
    command=Structure(()),
)
"""Version 3, which the hands of the Panda speak."""
