"""Check poses: find pairs of bodies that are too near for a path."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from station.core.errors import NoPathError
from station.core.franka.franka_services import FrankaServices
from station.rehearsal.path_search import Joints

if TYPE_CHECKING:
    from station.core.facade.station import Station

MARGIN = 0.01
"""Least distance of bodies that are farther apart at the beginning [m]. For an object
with a role, it is added to the object's own margin."""
DEPTH = 0.001
"""How much nearer two bodies may come that are near each other at the beginning [m]."""
_APART = 0.035
"""Least distance of two parts of a Franka [m]; the arm ends a motion at 0.03."""

Pair = tuple[str, str, float, float]
"""Names of two bodies, their distance [m], and the distance to keep [m]."""


class PoseJudge:
    """Finds pairs that are too near in a pose; in a copy of the station only.

    MuJoCo finds solid bodies, the scene guards find objects with a role, and the model
    of each Franka finds its own parts.

    Args:
        station: The station; its world stays in the pose that was checked last.
        joints: Names of the joints of a pose.
        start: First pose [rad or m]; pairs that are near in this pose may stay near.

    Raises:
        NoPathError: The robot is not simulated.
    """

    def __init__(
        self, station: "Station", joints: Sequence[str], start: Joints
    ) -> None:
        world = station.loop.hw.simulated_world()
        if world is None:
            raise NoPathError(
                "What is around a real robot is not known.",
                remedy="Plan on a simulated station with its scene.",
            )
        self._joints = joints
        self._surroundings = station.surroundings
        kind: type[FrankaServices] = FrankaServices  # type: ignore[type-abstract]
        self._arms = []
        for arm_id in station.robots.names(kind):
            arm = station.robots.get(arm_id, kind)
            names = [f"{arm_id}_joint{number}" for number in range(1, 8)]
            if arm is not None and set(names) & set(joints):
                q = arm.get_robot_state().q
                self._arms.append((arm.model().model, arm_id, names, q))
        carried = {
            one.name: f"{one.carried_by}_link7"
            for one in station.scene()
            if one.solid and one.carried_by
        }
        self._near = world.nearness(joints, MARGIN, carried)
        self._allowed: dict[tuple[str, str], float] = {}
        for one, other, distance, _ in self._pairs(start):
            before = self._allowed.get((one, other), distance)
            self._allowed[one, other] = min(before, distance)

    def blocked(self, pose: Joints, slack: float = DEPTH) -> list[Pair]:
        """Return the pairs that are nearer to each other than they may be.

        Args:
            pose: Positions of the joints [rad or m], shape (n,).
            slack: How much nearer than allowed a pair may be [m].
        """
        return [
            pair
            for pair in self._pairs(pose)
            if pair[2] < self._allowed.get(pair[:2], pair[3]) - slack
        ]

    def is_clear(self, pose: Joints) -> bool:
        """Return whether no pair is nearer than allowed."""
        return not self.blocked(pose)

    def _pairs(self, pose: Joints) -> list[Pair]:
        """Return the pairs that are nearer than the distance to keep."""
        values = pose.tolist()
        found = [(*pair, MARGIN) for pair in self._near(values)]
        positions = dict(zip(self._joints, values, strict=True))
        for pair in self._surroundings.nearest_at(positions):
            kept = pair.margin + MARGIN
            if pair.distance < kept:
                link = f"{pair.arm}_{pair.link}"
                found.append((link, pair.object, pair.distance, kept))
        for model, arm_id, names, here in self._arms:
            q = [positions.get(n, value) for n, value in zip(names, here, strict=True)]
            apart = model.clearance(q)
            if apart < _APART:
                found.append((arm_id, "itself", apart, _APART))
        return found
