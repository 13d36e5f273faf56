"""The world of the mock: ideal joints, their time, and a reset of both."""

from collections.abc import Mapping, Sequence

from typing_extensions import override

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    PosVelAccJointInterface,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import SimulatedWorld

POSITION_MODES = frozenset({
    PositionJointInterface.type_name,
    PosVelJointInterface.type_name,
    PosVelAccJointInterface.type_name,
})
"""Modes in which a joint goes where it is commanded."""
IDLE = ""
"""Mode of a joint that no controller claims; the joint stands still."""


class MockJoints:
    """Ideal joints, which follow their commands at once.

    A joint under position control is where it is commanded, under velocity control it
    moves with that velocity, under effort control it accelerates with effort over
    inertia minus friction, and otherwise it stands still.

    Args:
        positions: Initial positions [rad or m], shape (n,).
        inertia: Inertia of every joint [kg m^2 or kg], > 0.
        damping: Viscous friction of every joint [Nm s/rad or N s/m], >= 0.

    Attributes:
        position, velocity, effort: The true state, shape (n,).
        position_command, velocity_command, acceleration_command, effort_command: What
            controllers write, shape (n,).
        mode: Name of the interface that commands a joint, `IDLE` when none does.
    """

    def __init__(
        self, positions: list[float], inertia: float = 1.0, damping: float = 1.0
    ) -> None:
        count = len(positions)
        self.position = list(positions)
        self.velocity = [0.0] * count
        self.effort = [0.0] * count
        self.position_command = list(positions)
        self.velocity_command = [0.0] * count
        self.acceleration_command = [0.0] * count
        self.effort_command = [0.0] * count
        self.mode = [IDLE] * count
        self._inertia = inertia
        self._damping = damping

    def place(self, positions: list[float]) -> None:
        """Put the joints at rest at a pose, which becomes their commanded pose as well.

        Args:
            positions: [rad or m], shape (n,).
        """
        self.position[:] = self.position_command[:] = positions
        for values in (
            self.velocity,
            self.effort,
            self.velocity_command,
            self.acceleration_command,
            self.effort_command,
        ):
            values[:] = [0.0] * len(positions)

    def advance(self, period: float) -> None:
        """Let `period` [s] pass, >= 0."""
        for index, mode in enumerate(self.mode):
            if mode in POSITION_MODES:
                self._follow_position(index, period)
            elif mode == VelocityJointInterface.type_name:
                self._move(index, self.velocity_command[index], period)
            elif mode == EffortJointInterface.type_name:
                self._accelerate(index, period)
            else:
                self._move(index, 0.0, period)

    def _follow_position(self, index: int, period: float) -> None:
        before = self.position[index]
        self.position[index] = self.position_command[index]
        step = self.position[index] - before
        self.velocity[index] = step / period if period > 0.0 else 0.0
        self.effort[index] = 0.0

    def _move(self, index: int, velocity: float, period: float) -> None:
        self.velocity[index] = velocity
        self.position[index] += velocity * period
        self.effort[index] = 0.0

    def _accelerate(self, index: int, period: float) -> None:
        self.effort[index] = self.effort_command[index]
        # Implicit in the friction: stable for every period.
        momentum = self.velocity[index] + self.effort[index] * period / self._inertia
        velocity = momentum / (1.0 + self._damping * period / self._inertia)
        self.velocity[index] = velocity
        self.position[index] += velocity * period


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
