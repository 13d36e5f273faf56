"""The scene around the robots, changed while the station runs."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from station.core.description.urdf import Pose
from station.core.errors import (
    ParameterError,
    SceneObjectNotFoundError,
    SceneRefusedError,
    suggest,
)
from station.core.facade.input_log import InputLog
from station.core.facade.robots import Robots
from station.core.geometry.capsules import load_of
from station.core.geometry.scene import SceneObject, read_object, read_scene
from station.core.hardware.robot_hw import SceneGuard
from station.core.hardware.robot_report import SceneObjectReport
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.reports import Clearance


class StationScene:
    """Holds the objects, and passes them to the robots' guards. Any thread.

    Solid objects are bodies of the simulated world, which is built once: they can be
    moved, but not added or removed.

    Args:
        loop: The loop, not yet started.
        parameters: The root of the parameters, with `scene`.
        robots: The robots, for the loads of their arms.
        inputs: Receives every change.

    Raises:
        ParameterError: The scene is malformed, or the robot has no guard for its roles.
        RobotDescriptionError: A mesh of an object with a role cannot be used.
    """

    def __init__(
        self,
        loop: ControlLoop,
        parameters: Parameters,
        robots: Robots,
        inputs: InputLog,
    ) -> None:
        self._loop = loop
        self._robots = robots
        self._inputs = inputs
        self._lock = threading.Lock()
        self._guards = tuple(loop.hw.guards())
        self._arm_margin = _arm_margin(parameters)
        self._objects: tuple[SceneObject, ...] = ()
        objects = read_scene(parameters)
        if any(one.role != "object" for one in objects) or self._arm_margin is not None:
            loop.run_in_cycle(self._changes(objects))
        self._objects = tuple(objects)

    def report(self) -> list[SceneObjectReport]:
        """Return all objects, solid ones at their present poses.

        Raises:
            LoopError: The loop died or hangs.
        """
        world = self._loop.hw.simulated_world()
        found = [] if world is None else self._loop.run_in_cycle(world.scene)
        present = {one.name: one for one in found}
        objects = self._objects
        if any(one.carried_by for one in objects):
            objects = self._loop.run_in_cycle(lambda: tuple(map(self._moved, objects)))
        known = {one.name: one for one in objects}
        others = [one for one in objects if one.name not in present]
        return [
            *(_described(one, known.get(one.name)) for one in found),
            *(_described(_report(one), one) for one in others),
        ]

    def clearances(self) -> list[Clearance]:
        """Return the nearest pair of each arm that has something to keep clear of."""
        found = (guard.report() for guard in self._guards)
        return [one for one in found if one is not None]

    def clearance(self, arm_id: str) -> Clearance | None:
        """Return the nearest pair of an arm; None without anything to keep clear of."""
        return next((one for one in self.clearances() if one.arm == arm_id), None)

    def nearest_at(self, positions: Mapping[str, float]) -> list[Clearance]:
        """Return the nearest pair of each arm in a pose; only in a copy of a station.

        Args:
            positions: Joint name to position [rad]; other joints stay as they are.
        """
        found = (guard.nearest_at(positions) for guard in self._guards)
        return [one for one in found if one is not None]

    def put(self, name: str, values: Mapping[str, object]) -> SceneObjectReport:
        """Add an object, or change the object of that name.

        Args:
            name: Name of the object.
            values: Values by the keys of `scene/objects`; other keys stay.

        Raises:
            ParameterError: A value is impossible.
            SceneRefusedError: A solid object refuses such a change while it runs.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            old = next((one for one in self._objects if one.name == name), None)
            if old is not None:
                self._refuse_carried(old)
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
            placed = []
            if old is not None and (old.solid or thing.solid):
                self._refuse_rebuilding(old, thing)
                placed = [] if {"position", "rpy"}.isdisjoint(values) else [name]
            self._loop.run_in_cycle(self._exchange([thing], placed=placed))
        return next(one for one in self.report() if one.name == name)

    def remove(self, name: str) -> None:
        """Remove an object.

        Raises:
            SceneObjectNotFoundError: There is no object of that name.
            SceneRefusedError: The object is solid.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            thing = self._find(name)
            self._refuse_carried(thing)
            if thing.solid:
                raise SceneRefusedError(
                    f"'{name}' is a solid object of the simulated world.",
                    remedy="Move it away, or take it out of scene.objects and start "
                    "again.",
                    details={"object": name},
                )
            self._loop.run_in_cycle(self._exchange([], [name]))

    def attach(
        self, name: str, arm_id: str = "", *, load: bool = True
    ) -> SceneObjectReport:
        """Let an arm carry an object, which then moves and is guarded with the hand.

        Args:
            name: The object; it is attached at its present pose.
            arm_id: The arm; may be empty if there is only one.
            load: Whether the load of the arm is set, too.

        Raises:
            SceneObjectNotFoundError: There is no object of that name.
            SceneRefusedError: The object is carried already, or is a fence or a
                half-space, or the robot has no such arm.
            RobotDescriptionError: A mesh cannot be used.
            InvalidCommandError: The arm cannot carry that mass.
            ArmCommandError: The arm moves, so that its load cannot be set.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            thing = self._find(name)
            self._refuse_carried(thing)
            guard = self._guard_of(arm_id)
            if thing.role == "fence":
                raise SceneRefusedError(
                    f"'{name}' is a fence, which no arm carries.",
                    remedy="Attach an object or a keep_out.",
                    details={"object": name},
                )
            grip = self._loop.run_in_cycle(
                lambda: guard.hand().inverse().compose(self._pose_of(thing))
            )
            held = replace(thing, carried_by=guard.arm_id, grip=grip)
            self._change_load(held, guard.arm_id, tell_arm=load)
        return next(one for one in self.report() if one.name == name)

    def detach(self, name: str, *, load: bool = True) -> SceneObjectReport:
        """Let an object stay at its present pose, no longer carried by an arm.

        Args:
            name: The object.
            load: Whether the load of the arm is set to the objects that it still
                carries.

        Raises:
            SceneObjectNotFoundError: There is no object of that name.
            SceneRefusedError: No arm carries the object.
            ArmCommandError: The arm moves, so that its load cannot be set.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            thing = self._find(name)
            if not thing.carried_by:
                raise SceneRefusedError(
                    f"No arm carries '{name}'.", remedy="", details={"object": name}
                )
            left = self._loop.run_in_cycle(lambda: self._moved(thing))
            left = replace(left, carried_by="", grip=Pose())
            self._change_load(left, thing.carried_by, tell_arm=load)
        return next(one for one in self.report() if one.name == name)

    def _change_load(self, thing: SceneObject, arm_id: str, *, tell_arm: bool) -> None:
        """Replace an object, and set the load of the arm that takes or releases it."""
        change = self._exchange([thing])
        if tell_arm:
            others = [one for one in self._objects if one.name != thing.name]
            held = [
                (one, one.grip) for one in (*others, thing) if one.carried_by == arm_id
            ]
            mass, center, inertia = load_of(held)
            service, set_load = self._robots.find_service(arm_id, "set_load")
            self._loop.run_in_cycle(
                lambda: set_load(
                    mass=mass, F_x_center_load=center, load_inertia=inertia
                ),
                moves=service.moves,
            )
        # The load is set first: a moving arm refuses it, and nothing has changed then.
        self._loop.run_in_cycle(change)

    def _find(self, name: str) -> SceneObject:
        """Return an object.

        Raises:
            SceneObjectNotFoundError: There is no such object.
        """
        names = [one.name for one in self._objects]
        if name not in names:
            raise SceneObjectNotFoundError(
                f"The scene has no object '{name}'.", remedy=suggest(name, names)
            )
        return self._objects[names.index(name)]

    def _refuse_carried(self, thing: SceneObject) -> None:
        """Refuse to change an object that an arm carries.

        Raises:
            SceneRefusedError: An arm carries it.
        """
        if thing.carried_by:
            raise SceneRefusedError(
                f"'{thing.name}' is carried by '{thing.carried_by}'.",
                remedy="Detach it first.",
                details={"object": thing.name},
            )

    def _guard_of(self, arm_id: str) -> SceneGuard:
        """Return the guard of an arm; with an empty name, of the only arm.

        Raises:
            SceneRefusedError: There is no such guard, or the name is empty and there
                are several.
        """
        names = [one.arm_id for one in self._guards]
        if arm_id in names:
            return self._guards[names.index(arm_id)]
        if not arm_id and len(names) == 1:
            return self._guards[0]
        raise SceneRefusedError(
            f"The robot has no arm '{arm_id}' that could carry something."
            if arm_id
            else "Which arm is to carry it?",
            remedy=f"Name one of: {', '.join(names)}."
            if names
            else "Only Franka arms carry objects.",
            details={"arms": names},
        )

    def _pose_of(self, thing: SceneObject) -> Pose:
        """Return the pose of an object's middle in the world; control thread."""
        world = self._loop.hw.simulated_world()
        for one in () if world is None else world.scene():
            if one.name == thing.name:
                px, py, pz = one.position
                x, y, z, w = one.orientation
                return Pose((px, py, pz), (w, x, y, z))
        return thing.pose()

    def _moved(self, thing: SceneObject) -> SceneObject:
        """Return an object at its present pose; control thread."""
        if not thing.carried_by or thing.solid:
            return thing.at(self._pose_of(thing)) if thing.carried_by else thing
        hand = self._guard_of(thing.carried_by).hand()
        return thing.at(hand.compose(thing.grip))

    def entries(self) -> list[dict[str, object]]:
        """Return the objects with a role that no arm carries, for `replace_roles`."""
        return [
            _entry(one) for one in self._objects if not one.solid and not one.carried_by
        ]

    def replace_roles(self, entries: Sequence[Mapping[str, object]]) -> None:
        """Replace all objects except those that are solid or carried by an arm.

        Args:
            entries: Objects, as in `scene/objects`.

        Raises:
            ParameterError: An entry is malformed, or names a solid object.
            LoopError: The loop died or hangs.
        """
        found = [read_object(one, f"scene/{i}") for i, one in enumerate(entries)]
        with self._lock:
            kept = [one for one in self._objects if one.solid or one.carried_by]
            names = [one.name for one in (*kept, *found)]
            if len(set(names)) < len(names) or any(one.solid for one in found):
                raise ParameterError(
                    "A kept scene has a solid object, or a name twice.",
                    remedy="Keep only objects with the role keep_out or fence in it.",
                )
            gone = [one.name for one in self._objects if one not in kept]
            self._loop.run_in_cycle(self._exchange(found, gone))

    def repeat(
        self,
        changed: Sequence[Mapping[str, object]],
        removed: Sequence[str],
        placed: Sequence[str],
    ) -> None:
        """Repeat a change of the scene that was noted as an input.

        Args:
            changed: The objects that changed, as `_noted` returns them.
            removed: Names of removed objects.
            placed: Names of the bodies of the simulated world that were moved.

        Raises:
            ParameterError: An object is impossible.
            LoopError: The loop died or hangs.
        """
        with self._lock:
            things = [_repeated(one) for one in changed]
            self._loop.run_in_cycle(self._exchange(things, removed, placed))

    def _refuse_rebuilding(self, old: SceneObject, new: SceneObject) -> None:
        """Refuse a change that would need another body in the simulated world.

        Raises:
            SceneRefusedError: More changes than pose, role, margin, links or colour.
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

    def _exchange(
        self,
        changed: Sequence[SceneObject],
        removed: Sequence[str] = (),
        placed: Sequence[str] = (),
    ) -> Callable[[], None]:
        """Return a function for the control thread that changes the scene.

        Args:
            changed: Objects that are new, or replace the objects of the same name.
            removed: Names of objects to remove.
            placed: Names of bodies of the simulated world that move to their pose.

        Raises:
            ParameterError: The robot has no guard for the roles, or lacks the links.
            RobotDescriptionError: A mesh cannot be used.
        """
        gone = {*removed, *(one.name for one in changed)}
        kept = [one for one in self._objects if one.name not in gone]
        objects = (*kept, *changed)
        change, world = self._changes(objects), self._loop.hw.simulated_world()
        noted = [_noted(one) for one in changed]

        def exchange() -> None:
            for one in changed:
                if world is not None and one.name in placed:
                    world.place_object(one.name, one.pose())
            change()
            self._objects = objects
            self._inputs.note_in_cycle(
                "scene", changed=noted, removed=[*removed], placed=[*placed]
            )

        return exchange

    def _refuse_unknown_links(self, thing: SceneObject) -> None:
        """Refuse a role for a link that no robot has.

        Raises:
            ParameterError: The object names such a link.
        """
        for name in thing.links:
            if not any(guard.knows(name) for guard in self._guards):
                known = [link for guard in self._guards for link in guard.links()]
                raise ParameterError(
                    f"The object '{thing.name}' counts for the link '{name}', which "
                    "no arm has.",
                    remedy=f"There are: {', '.join(dict.fromkeys(known))}.",
                    details={"parameter": "links"},
                )

    def _changes(self, objects: Sequence[SceneObject]) -> Callable[[], None]:
        """Return a function for the control thread that informs all guards.

        Raises:
            ParameterError: The robot has no guard for the roles, or lacks the links.
            RobotDescriptionError: A mesh cannot be used.
        """
        free = self._loop.hw.unguarded()
        for one in objects:
            if one.role == "object":
                continue
            # A role for certain links concerns only the arms that have them.
            if not free or (one.links and self._guards):
                self._refuse_unknown_links(one)
                continue
            names = " and ".join(f"'{name}'" for name in free if name)
            raise ParameterError(
                f"'{one.name}' has the role {one.role}, and {names or 'this robot'} "
                "has no guard: only Franka arms and simulated robots with a fixed "
                "base, motors and collision geometry have one.",
                remedy="Give it the role 'object'"
                + (", or the links that it is for." if self._guards else "."),
                details={"parameter": "scene/objects", "robots": [*free]},
            )
        # Rows and hulls are computed here. The control thread only exchanges them, all
        # in one cycle, because each arm uses the capsules of the others.
        changes = [one.carry(objects) for one in self._guards]
        changes += [one.prepare(objects, self._arm_margin) for one in self._guards]

        def change() -> None:
            for one in changes:
                one()

        return change


def _arm_margin(parameters: Parameters) -> float | None:
    """Return the distance that arms keep from each other [m]; None for none.

    Raises:
        ParameterError: The value is not a number >= 0.
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


def _noted(thing: SceneObject) -> dict[str, object]:
    """Return all properties of an object as JSON-compatible values."""
    grip = [*thing.grip.xyz, *thing.grip.quaternion]
    return {**_entry(thing), "carried_by": thing.carried_by, "grip": grip}


def _repeated(noted: Mapping[str, Any]) -> SceneObject:
    """Return the object whose properties `_noted` has returned.

    Raises:
        ParameterError: The object is impossible, such as a mesh whose file is gone.
    """
    own = ("carried_by", "grip")
    entry = {key: value for key, value in noted.items() if key not in own}
    x, y, z, *quaternion = noted["grip"]
    return replace(
        read_object(entry, f"scene/{noted['name']}"),
        carried_by=noted["carried_by"],
        grip=Pose((x, y, z), tuple(quaternion)),
    )


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
        carried_by=thing.carried_by,
    )
