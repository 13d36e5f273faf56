"""Write the state of an arm into the message that a client receives every cycle."""

import struct
from typing import TYPE_CHECKING

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.fci.wire.robot_protocol import RobotProtocol

if TYPE_CHECKING:
    from station.memory.doubles import Doubles

_FIRST_DOUBLE = "O_T_EE"
_BEHIND_DOUBLES = "motion_generator_mode"
_DOUBLE = struct.Struct("<d")
_ID = struct.Struct("<Q")


class StateWriter:
    """Keeps one message and brings it up to date in place. Control thread.

    The fields of the message are those of `RobotState`; libfranka calls the flags of
    the present errors `errors` on the wire, and those of the last motion
    `reflex_reason`.

    Args:
        state: The arm's live state.
        protocol: The version of the protocol.

    Attributes:
        message: The message.
    """

    def __init__(self, state: RobotState, protocol: RobotProtocol) -> None:
        self._state = state
        layout = protocol.state
        self.message = bytearray(layout.size)
        self._places = layout.offsets
        first, last = layout.offsets[_FIRST_DOUBLE], layout.offsets[_BEHIND_DOUBLES]
        # All doubles but the last follow each other.
        numbers = memoryview(self.message)[first:last].cast("d")
        self._arrays: list[tuple[Doubles, Doubles]] = []
        self._masses: list[tuple[str, int]] = []
        for name, offset in layout.offsets.items():
            if not first <= offset < last:
                continue
            place, count = (offset - first) // 8, layout.counts[name]
            if name in ("m_ee", "m_load"):
                self._masses.append((name, offset))
            else:
                source = state.doubles(name)
                self._arrays.append((numbers[place : place + count], source))

    def write(self, message_id: int, generator: int, controller: int) -> bytearray:
        """Bring `message` up to date with the arm's state, and return it.

        Args:
            message_id: Number of the message, which grows by 1 per cycle.
            generator: `motion_generator_mode` on the wire.
            controller: `controller_mode` on the wire.
        """
        state, message, places = self._state, self.message, self._places
        _ID.pack_into(message, 0, message_id)
        for target, source in self._arrays:
            target[:] = source
        for name, place in self._masses:
            _DOUBLE.pack_into(message, place, getattr(state, name))
        message[places["motion_generator_mode"]] = generator
        message[places["controller_mode"]] = controller
        for name, flags in (
            ("errors", state.current_errors),
            ("reflex_reason", state.last_motion_errors),
        ):
            message[places[name] : places[name] + len(flags)] = bytes(flags)
        message[places["robot_mode"]] = state.robot_mode.value
        _DOUBLE.pack_into(
            message,
            places["control_command_success_rate"],
            state.control_command_success_rate,
        )
        return message
