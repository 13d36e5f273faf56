"""The world of a simulated robot, as the control loop and the facade see it."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from math import inf

from station.core.hardware.robot_report import (
    ContactReport,
    MovingBaseReport,
    SceneObjectReport,
)


class SimulatedWorld(ABC):
    """The extras of a simulated robot: a time of its own, a scene, and a reset.

    `RobotHW.simulated_world` hands it out; a real robot has none. All methods belong to
    the control thread, between two cycles or within one.
    """

    @abstractmethod
    def time(self) -> float:
        """Return the simulated time since the last reset [s]."""

    @abstractmethod
    def reset(self, positions: Mapping[str, float]) -> None:
        """Put the world back to its start: time and velocities become zero.

        The loop voids all commands and restarts the running controllers afterwards.

        Args:
            positions: Joint name to position [rad or m]; joints that are not named go
                back to where they began.

        Raises:
            HardwareInterfaceError: A joint is not in the world; nothing changed.
        """

    def keyframes(self) -> Mapping[str, Mapping[str, float]]:
        """Return the poses that have a name: joint name to position [rad or m]."""
        return {}

    def scene(self) -> Sequence[SceneObjectReport]:
        """Return the objects around the robot, at their present poses."""
        return ()

    def bases(self) -> Sequence[MovingBaseReport]:
        """Return the poses of the robots' moving root links; without the fixed ones."""
        return ()

    def contacts(self) -> Sequence[ContactReport]:
        """Return the contacts of the world's bodies; of very many points only some."""
        return ()

    def longest_period(self) -> float:
        """Return the most time that may pass in one cycle of the loop [s], > 0.

        A world may wait for a loop that is very late; station time then stands still,
        too. The default is infinity: the world never waits.
        """
        return inf
