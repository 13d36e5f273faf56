"""The scene around the robots, changed while the station runs."""

import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace

from station.core.errors import (
    ParameterError,
    SceneObjectNotFoundError,
    SceneRefusedError,
    suggest,
)
from station.core.geometry.scene import SceneObject, read_object, read_scene
from station.core.hardware.robot_report import SceneObjectReport
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.reports import Clearance


class StationScene:
    """Holds the objects and lets the robots' guards know. Any thread.

    Solid objects are bodies of the simulated world, which is built once: they can be
    moved, but not added or removed.

    Args:
        loop: The loop, not yet started.
        parameters: The root of the parameters, with `scene`.

    Raises:
        ParameterError: The scene is malformed, or the robot has no guard for its roles.
        RobotDescriptionError: A mesh of an object with a role cannot be used.
    """

    def __init__(self, loop: ControlLoop, parameters: Parameters) -> None:
        self._loop = loop
        self._lock = threading.Lock()
        self._guards = tuple(loop.hw.guards())
        self._arm_margin = _arm_margin(parameters)
        self._objects: tuple[SceneObject, ...] = ()
        objects = read_scene(parameters)
        if any(one.role != "object" for one in objects) or self._arm_margin is not None:
            self._apply(objects)
        self._objects = tuple(objects)

    def report(self) -> list[SceneObjectReport]:
        """Return all objects, solid ones where they are now.

        Raises:
            LoopError: The loop died or hangs.
        """
        world = self._loop.hw.simulated_world()
        found = [] if world is None else self._loop.run_in_cycle(world.scene)
        present = {one.name: one for one in found}
        known = {one.name: one for one in self._objects}
        others = [one for one in self._objects if one.name not in present]
        return [
            *(_described(one, known.get(one.name)) for one in found),
            *(_described(_report(one), one) for one in others),
        ]

    def clearances(self) -> list[Clearance]:
        """Return the nearest pair of each arm that keeps clear of something."""
        found = (guard.report() for guard in self._guards)
        return [one for one in found if one is not None]

    def clearance(self, arm_id: str) -> Clearance | None:
        """Return the nearest pair of an arm; None if it keeps clear of nothing."""
        return next((one for one in self.clearances() if one.arm == arm_id), None)

    def put(self, name: str, values: Mapping[str, object]) -> SceneObjectReport:
        """Add an object, or change the one of that name.

        Args:
            name: Its name.
            values: Keys of `scene/objects`; what is left out keeps its value.

        Raises:
            ParameterError: A value is impossible.
            SceneRefusedError: A solid object cannot be changed so while it runs.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            old = next((one for one in self._objects if one.name == name), None)
            entry = {**(_entry(old) if old else {}), **values, "name": name}
            thing = read_object(entry, f"scene/{name}")
            if old is None and thing.solid:
                raise SceneRefusedError(
                    f"'{name}' is a solid object, and the simulated world is built "
                    "once.",
                    remedy="Give it the role keep_out or fence, or put it into "
                    "scene.objects of the configuration and start again.",
                    details={"object": name},
                )
            if old is not None and (old.solid or thing.solid):
                self._move_solid(old, thing)
            objects = [one for one in self._objects if one.name != name]
            self._apply([*objects, thing])
            self._objects = (*objects, thing)
        return next(one for one in self.report() if one.name == name)

    def remove(self, name: str) -> None:
        """Remove an object.

        Raises:
            SceneObjectNotFoundError: There is no object of that name.
            SceneRefusedError: It is solid.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            names = [one.name for one in self._objects]
            if name not in names:
                raise SceneObjectNotFoundError(
                    f"The scene has no object '{name}'.", remedy=suggest(name, names)
                )
            thing = self._objects[names.index(name)]
            if thing.solid:
                raise SceneRefusedError(
                    f"'{name}' is a solid object of the simulated world.",
                    remedy="Move it away, or take it out of scene.objects and start "
                    "again.",
                    details={"object": name},
                )
            kept = [one for one in self._objects if one.name != name]
            self._apply(kept)
            self._objects = tuple(kept)

    def entries(self) -> list[dict[str, object]]:
        """Return the objects with a role, as `replace_roles` takes them."""
        return [_entry(one) for one in self._objects if not one.solid]

    def replace_roles(self, entries: Sequence[Mapping[str, object]]) -> None:
        """Replace all objects that are not solid.

        Args:
            entries: Objects, as in `scene/objects`.

        Raises:
            ParameterError: An entry is malformed, or names a solid object.
            LoopError: The loop died or hangs.
        """
        found = [read_object(one, f"scene/{i}") for i, one in enumerate(entries)]
        with self._lock:
            kept = [one for one in self._objects if one.solid]
            names = [one.name for one in (*kept, *found)]
            if len(set(names)) < len(names) or any(one.solid for one in found):
                raise ParameterError(
                    "A kept scene has a solid object, or a name twice.",
                    remedy="Keep only objects with the role keep_out or fence in it.",
                )
            self._apply([*kept, *found])
            self._objects = (*kept, *found)

    def _move_solid(self, old: SceneObject, new: SceneObject) -> None:
        """Move a body of the simulated world.

        Raises:
            SceneRefusedError: More than pose, role or margin is to change.
        """
        world = self._loop.hw.simulated_world()
        same = replace(
            new,
            position=old.position,
            rpy=old.rpy,
            role=old.role,
            margin=old.margin,
            links=old.links,
            colour=old.colour,
        )
        if same != old or world is None:
            raise SceneRefusedError(
                f"'{old.name}' is a body of the simulated world, which is built once.",
                remedy="Change its pose, role, margin, links or colour alone.",
                details={"object": old.name},
            )
        if (new.position, new.rpy) != (old.position, old.rpy):
            pose = new.pose()
            self._loop.run_in_cycle(lambda: world.place_object(new.name, pose))

    def _apply(self, objects: Sequence[SceneObject]) -> None:
        """Let the guards of all arms know.

        Raises:
            ParameterError: The robot has no guard for the roles, or not the links.
            RobotDescriptionError: A mesh cannot be used.
            LoopError: The loop died or hangs.
        """
        roles = [one for one in objects if one.role != "object"]
        if roles and not self._guards:
            raise ParameterError(
                f"'{roles[0].name}' has the role {roles[0].role}, and this robot has "
                "no guard: only a Franka has one.",
                remedy="Give it the role 'object', or leave it out.",
                details={"parameter": "scene/objects"},
            )
        # Rows and hulls are made here; the control thread only exchanges them.
        changes = [one.prepare(objects, self._arm_margin) for one in self._guards]
        for change in changes:
            self._loop.run_in_cycle(change)


def _arm_margin(parameters: Parameters) -> float | None:
    """Return the distance that arms keep from each other [m]; None for none.

    Raises:
        ParameterError: It is no number of 0 or more.
    """
    found = parameters.get("scene/arm_margin", None)
    if found is None:
        return None
    if isinstance(found, bool) or not isinstance(found, (int, float)) or found < 0.0:
        raise ParameterError(
            f"'scene/arm_margin' is {found!r}; it must be 0 or more [m].",
            remedy="Correct the configuration.",
            details={"parameter": "scene/arm_margin"},
        )
    return float(found)


def _entry(thing: SceneObject) -> dict[str, object]:
    entry: dict[str, object] = {
        "name": thing.name,
        "type": thing.kind,
        "size": [*thing.size],
        "position": [*thing.position],
        "rpy": [*thing.rpy],
        "mass": thing.mass,
        "friction": thing.friction,
        "role": thing.role,
        "margin": thing.margin,
        "links": [*thing.links],
        "colour": [*thing.colour],
        "solid": thing.solid,
    }
    return {**entry, "file": thing.file} if thing.file else entry


def _report(thing: SceneObject) -> SceneObjectReport:
    pose = thing.pose()
    w, x, y, z = pose.quaternion
    return SceneObjectReport(
        thing.name, thing.kind, thing.size, pose.xyz, (x, y, z, w), thing.mass,
        thing.file,
    )  # fmt: skip


def _described(
    found: SceneObjectReport, thing: SceneObject | None
) -> SceneObjectReport:
    if thing is None:
        return found
    return replace(
        found,
        role=thing.role,
        margin=thing.margin,
        links=thing.links,
        colour=thing.colour,
        solid=thing.solid,
    )
