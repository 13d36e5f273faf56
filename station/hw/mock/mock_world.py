"""The world of the mock: its joints, its time, and a reset of both."""

from collections.abc import Mapping, Sequence

from typing_extensions import override

from station.core.errors import HardwareInterfaceError
from station.core.hardware.simulated_world import SimulatedWorld
from station.hw.mock.mock_joints import MockJoints


class MockWorld(SimulatedWorld):
    """Advances ideal joints in time. Control thread only.

    Args:
        names: Names of the joints.
        joints: The joints; a reset puts them back to where they are now.
    """

    def __init__(self, names: Sequence[str], joints: MockJoints) -> None:
        self._names = tuple(names)
        self._joints = joints
        self._start = list(joints.position)
        self._time = 0.0

    def advance(self, period: float) -> None:
        """Let `period` [s] pass, >= 0."""
        self._time += period
        self._joints.advance(period)

    @override
    def time(self) -> float:
        return self._time

    @override
    def reset(self, positions: Mapping[str, float]) -> None:
        places = {self._index(name): value for name, value in positions.items()}
        self._time = 0.0
        self._joints.place([
            places.get(index, start) for index, start in enumerate(self._start)
        ])

    def _index(self, joint: str) -> int:
        if joint not in self._names:
            raise HardwareInterfaceError(
                f"The mock has no joint '{joint}'.",
                remedy=f"Choose among {', '.join(self._names)}.",
                details={"joint": joint},
            )
        return self._names.index(joint)
