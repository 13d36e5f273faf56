"""Copies between the numbers of a state's message and those of `RobotState`."""

import numpy as np

from station.core.franka.franka_robot_state import RobotState, array_places
from station.hw.franka.fci.wire.structure import Structure

_FIRST_NUMBER = "O_T_EE"
_BEHIND_NUMBERS = "motion_generator_mode"
_LAST_NUMBER = "control_command_success_rate"
_MASSES = ("m_ee", "m_load")


class StateNumbers:
    """Copies all numbers between a message and a state. Control thread.

    The fields of the message that are arrays have their names in `RobotState`; whether
    the version has single or double precision makes no other difference.

    Args:
        layout: The structure of the message.
        message: The message; longer is allowed.
        state: The state.

    Attributes:
        accelerations: Accelerations in the message [m/s^2], shape (36,); (0,) in
            versions without accelerometers.
    """

    def __init__(
        self, layout: Structure, message: bytearray, state: RobotState
    ) -> None:
        self._layout, self._message, self._state = layout, message, state
        places = array_places()
        first, behind = layout.offsets[_FIRST_NUMBER], layout.offsets[_BEHIND_NUMBERS]
        size = layout.size - layout.offsets[_LAST_NUMBER]
        # Index in the state's block of each number of the message.
        indices: list[int] = []
        self._masses: list[tuple[str, int]] = []
        for name, offset in layout.offsets.items():
            if name in _MASSES:
                self._masses.append((name, len(indices)))
                indices.append(0)
            elif first <= offset < behind and name in places:
                start = places[name].start // 8
                indices += range(start, start + layout.counts[name])
        self._indices = np.array(indices)
        self._block = np.asarray(state.arrays())
        self._doubles = np.empty(len(indices))
        # The masses are not in the block: `read` leaves them out there.
        masses = [place for _, place in self._masses]
        self._of_arrays = np.delete(np.arange(len(indices)), masses)
        self._in_block = self._indices[self._of_arrays]
        self._arrays = np.empty(len(self._of_arrays))
        # All numbers but the last follow each other: first those of the state's arrays.
        numbers = np.frombuffer(memoryview(message)[first:behind], f"<f{size}")
        self._numbers, self.accelerations = np.split(numbers, [len(indices)])

    def write(self) -> None:
        """Bring the message up to date, all but the accelerations."""
        # Two steps without new memory: numbers of the block, then their precision.
        self._block.take(self._indices, out=self._doubles, mode="clip")
        for name, place in self._masses:
            self._doubles[place] = getattr(self._state, name)
        self._numbers[:] = self._doubles
        rate = self._state.control_command_success_rate
        self._layout.write(self._message, _LAST_NUMBER, rate)

    def read(self) -> None:
        """Bring the state up to date."""
        self._doubles[:] = self._numbers
        self._doubles.take(self._of_arrays, out=self._arrays, mode="clip")
        self._block.put(self._in_block, self._arrays, mode="clip")
        state = self._state
        for name, place in self._masses:
            setattr(state, name, float(self._doubles[place]))
        (rate,) = self._layout.read(self._message, _LAST_NUMBER)
        state.control_command_success_rate = rate
