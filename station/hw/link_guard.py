"""A guard that keeps the links of one robot clear of a scene."""

from collections.abc import Callable, Mapping, Sequence
from typing import NoReturn

from typing_extensions import override

from station.core.description.urdf import Pose
from station.core.errors import SceneRefusedError
from station.core.geometry.guard import Guard
from station.core.geometry.scene import SceneObject, solid_of
from station.core.hardware.robot_hw import SceneGuard
from station.memory.doubles import doubles
from station.reports import Clearance


class LinkGuard(SceneGuard):
    """Keeps one robot clear of its scene by slowing its commands.

    Args:
        arm_id: Name of the robot.
        base: Pose of the robot's base in the world.

    Attributes:
        guard: Computes the slowed commands.
        arm_id, base: As given.
    """

    guard: Guard

    def __init__(self, arm_id: str, base: Pose) -> None:
        self.arm_id, self.base = arm_id, base

    def positions(self) -> Mapping[str, float]:
        """Return joint positions [rad or m] by name, in the guard's order of joints."""
        raise NotImplementedError

    def watch(self, *, is_active: bool) -> None:
        """Let the guard check every command, or no command; control thread."""
        raise NotImplementedError

    def links_of(self, name: str, carried: Sequence[str] = ()) -> Sequence[str]:
        """Return the links of this robot to which a name in `links` refers.

        Args:
            name: Name of a link, or a name that stands for several links.
            carried: Names of the objects that the robot carries.
        """
        del carried
        return [name] if name in self.links() else []

    @override
    def knows(self, link: str) -> bool:
        return len(self.links_of(link)) > 0

    @override
    def hand(self) -> Pose:
        self._refuse_carrying()

    @override
    def carry(self, objects: Sequence[SceneObject]) -> Callable[[], None]:
        if any(one.carried_by == self.arm_id for one in objects):
            self._refuse_carrying()
        return lambda: None

    def _refuse_carrying(self) -> NoReturn:
        raise SceneRefusedError(
            f"'{self.arm_id}' carries nothing: only Franka arms do.",
            remedy="Leave the object where it is.",
            details={"arms": []},
        )

    @override
    def nearest_at(self, positions: Mapping[str, float]) -> Clearance | None:
        q = [positions.get(name, here) for name, here in self.positions().items()]
        if self.guard.is_active:
            self.guard.clearances.measure(doubles(q), 0.0)
        return self.report()

    @override
    def prepare(
        self, objects: Sequence[SceneObject], arm_margin: float | None
    ) -> Callable[[], None]:
        guard = self.guard
        triangles: list[float] = []
        # A carried object moves with its arm: other arms see it as a part of that arm.
        # A role for links of other robots does not concern this robot.
        counting = [
            one
            for one in objects
            if one.role != "object"
            and not one.carried_by
            and (not one.links or any(map(self.knows, one.links)))
        ]
        rows = [
            number for one in counting for number in solid_of(one, self.base, triangles)
        ]
        carried = [one.name for one in objects if one.carried_by == self.arm_id]
        links = [
            [link for name in one.links for link in self.links_of(name, carried)]
            for one in counting
        ]
        names = [one.name for one in counting]

        def apply() -> None:
            guard.set_scene(rows, triangles, names, arm_margin)
            for number, named in enumerate(links):
                if named:
                    guard.allow(number, named)
            self.watch(is_active=guard.is_active)

        return apply

    @override
    def report(self) -> Clearance | None:
        guard = self.guard
        pair = guard.clearances.pair
        if not guard.is_active or pair < 0:
            return None
        capsule, solid = divmod(pair, len(guard.things))
        return Clearance(
            arm=self.arm_id,
            link=guard.names[capsule],
            object=guard.things[solid],
            distance=guard.clearances.distance,
            margin=guard.margin_of(solid),
            is_slowing=guard.is_slowing,
            interventions=guard.interventions,
        )
