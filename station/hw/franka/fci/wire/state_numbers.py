"""Copies between the numbers of a state's message and those of `RobotState`."""

import numpy as np

from station.core.franka.franka_robot_state import RobotState, array_places
from station.hw.franka.fci.wire.structure import Structure

_LAST_NUMBER = "control_command_success_rate"
_SCALARS = ("m_ee", "m_load", _LAST_NUMBER)


class StateNumbers:
    """Copies all numbers between a message and a state. Control thread.

    The fields of the message that are arrays have their names in `RobotState`; whether
    the version has single or double precision makes no other difference.

    Args:
        layout: The structure of the message.
        message: The message; longer is allowed.
        state: The state.

    Attributes:
        accelerations: Accelerations on top and bottom of the boards in the message
            [m/s^2], shape (18,) each; (0,) in versions without accelerometers.
    """

    def __init__(
        self, layout: Structure, message: bytearray, state: RobotState
    ) -> None:
        self._layout, self._message, self._state = layout, message, state
        places = array_places()
        first = layout.offsets["O_T_EE"]
        behind = layout.offsets["motion_generator_mode"]
        size = layout.size - layout.offsets[_LAST_NUMBER]
        # Index in the state's block of each number of the message; any for the masses,
        # which are not in the block.
        indices: list[int] = []
        masses: list[int] = []
        for name, offset in layout.offsets.items():
            if name in _SCALARS[:2]:
                masses.append(len(indices))
                indices.append(0)
            elif first <= offset < behind and name in places:
                start = places[name].start // 8
                indices += range(start, start + layout.counts[name])
        self._indices = np.array(indices)
        self._block = np.asarray(state.arrays())
        self._doubles = np.empty(len(indices))
        self._of_arrays = np.delete(np.arange(len(indices)), masses)
        self._in_block = self._indices[self._of_arrays]
        self._arrays = np.empty(len(self._of_arrays))
        # All numbers but the last follow each other: first those of the state's arrays.
        numbers = np.frombuffer(memoryview(message)[first:behind], f"<f{size}")
        self._numbers, accelerations = np.split(numbers, [len(indices)])
        self.accelerations = np.split(accelerations, 2)

    def write(self) -> None:
        """Bring the message up to date, all but the accelerations."""
        # Two steps without new memory: numbers of the block, then their precision.
        self._block.take(self._indices, out=self._doubles, mode="clip")
        self._numbers[:] = self._doubles
        for name in _SCALARS:
            self._layout.write(self._message, name, getattr(self._state, name))

    def read(self) -> None:
        """Bring the state up to date."""
        self._doubles[:] = self._numbers
        self._doubles.take(self._of_arrays, out=self._arrays, mode="clip")
        self._block.put(self._in_block, self._arrays, mode="clip")
        for name in _SCALARS:
            setattr(self._state, name, self._layout.read(self._message, name)[0])
