"""The worlds of several simulated robots as one."""

from collections.abc import Mapping, Sequence

from typing_extensions import override

from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.robot_report import (
    ContactReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.core.hardware.simulated_world import SimulatedWorld


class CombinedWorld(SimulatedWorld):
    """Passes on what is asked to the worlds of simulated robots, in their order.

    Args:
        worlds: Each robot with its world; at least one.
    """

    def __init__(self, worlds: Sequence[tuple[RobotHW, SimulatedWorld]]) -> None:
        self._worlds = tuple(worlds)

    @override
    def time(self) -> float:
        """Return the time of the first robot's world [s]."""
        return self._worlds[0][1].time()

    @override
    def reset(self, positions: Mapping[str, float]) -> None:
        for robot, world in self._worlds:
            own = robot.resources()
            world.reset({n: p for n, p in positions.items() if n in own})

    @override
    def keyframes(self) -> Mapping[str, Mapping[str, float]]:
        """Return the keyframes of all worlds; those of one name are put together."""
        found: dict[str, dict[str, float]] = {}
        for _, world in self._worlds:
            for name, positions in world.keyframes().items():
                found.setdefault(name, {}).update(positions)
        return found

    @override
    def scene(self) -> Sequence[SceneObjectReport]:
        """Return the objects of all worlds; objects of one name are one object."""
        found = {
            thing.name: thing for _, world in self._worlds for thing in world.scene()
        }
        return list(found.values())

    @override
    def bases(self) -> Sequence[MovingBaseReport]:
        """Return the moving bases of all worlds."""
        return [base for _, world in self._worlds for base in world.bases()]

    @override
    def contacts(self) -> Sequence[ContactReport]:
        """Return the contacts of all worlds; worlds do not touch each other."""
        return [contact for _, world in self._worlds for contact in world.contacts()]

    @override
    def longest_period(self) -> float:
        """Return the period of the world that waits least [s]."""
        return max(world.longest_period() for _, world in self._worlds)
