"""An independent observer that checks a robot and its manager before every `write`.

It uses the public methods of robot and manager, and none of the code that
keeps the commands with their owners.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from station.core.control.chainable_controller import ChainableController
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchOutcome, SwitchResult
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    interface_type_name,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    RobotHW,
)

MOST_PROBLEMS = 50
"""Most problems that are kept; the first ones tell the most."""
UNRELEASED = "may still be in its mode"
"""Part of a controller's fault if its stop could not be passed to the robot."""


@dataclass(frozen=True, slots=True)
class CommandPlace:
    """One command of the robot.

    Attributes:
        claim: Wire name of the interface, and the resource.
        storage: The list that holds the command.
        index: Index in the list.
        rest: Function that returns the present rest command of the resource.
        slot: Identity of storage and index: several interfaces may share a command.
    """

    claim: tuple[str, str]
    storage: list[float]
    index: int
    rest: Callable[[], float]
    slot: tuple[int, int] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "slot", (id(self.storage), self.index))


class ChainCheck:
    """The check that no controller runs without the one whose references it commands.

    A reference has one owner at most. Its exporter is in chained mode if and only if
    the owner runs.

    Args:
        manager: The manager.
    """

    def __init__(self, manager: ControllerManager) -> None:
        self._manager = manager

    def __call__(self) -> str | None:
        """Return the first violation, or None; called by the control thread."""
        loaded = self._manager.lifecycle.loaded
        running = [one for one in loaded if one.controller.is_running()]
        owners: dict[str, str] = {}
        for place, one in enumerate(loaded):
            if one.following and any(e not in loaded[place:] for e in one.following):
                return f"'{one.info.name}' is not updated before what it commands"
        for one in running:
            missing = one.missing_following()
            if missing is not None:
                return f"'{one.info.name}' runs without '{missing.info.name}'"
            for name in one.info.references:
                if owners.setdefault(name, one.info.name) != one.info.name:
                    return f"'{name}' is owned by {owners[name]} and {one.info.name}"
        commanded = [each for one in running for each in one.following]
        for one in running:
            if isinstance(one.controller, ChainableController):
                chained = one.controller.is_in_chained_mode
                if chained != (one in commanded):
                    return f"chained mode of '{one.info.name}' is {chained}"
        return None


@dataclass(frozen=True, slots=True)
class _Ownership:
    """Resources of the running controllers; they last while the same ones run.

    Attributes:
        running: The running controllers.
        names: Names of the resources that they claim.
        owned: Identities of the commands that they claim.
        free: The commands without an owner.
    """

    running: Sequence[ControllerInfo]
    names: frozenset[str]
    owned: frozenset[tuple[int, int]]
    free: Sequence[CommandPlace]


class SwitchObserver:
    """Checks the end of every cycle, before the commands reach the hardware.

    It checks that every command is a finite float; that a resource has one owner at
    most, unless the robot allows more; that a command without an owner stays at the
    rest it got when it lost its owner; that joints without an owner do not move; and
    that the robot knows the running controllers.

    Args:
        robot: The robot, initialised. From now on the observer watches its `write` and
            `do_switch`, and those of the robots that it combines. Create the loop
            afterwards.
        manager: Its manager.
        may_share: Whether the robot lets several controllers own the same resource of
            the same interface.
        drift: How far a joint without an owner may move [rad or m].
        settling: Number of cycles without an owner after which a joint must be at rest.

    Attributes:
        problems: Violated contracts, one sentence each, at most `MOST_PROBLEMS`.
        cycle: Number of the last cycle that was checked, as `manager.cycle`.
        checks: Further checks for every cycle; each returns a problem or None.
    """

    def __init__(
        self,
        robot: RobotHW,
        manager: ControllerManager,
        *,
        may_share: bool = False,
        drift: float = math.inf,
        settling: int = 1000,
    ) -> None:
        self.problems: list[str] = []
        self.cycle = manager.cycle
        self.checks: list[Callable[[], str | None]] = []
        self._robot = robot
        self._manager = manager
        self._may_share = may_share
        self._drift = drift
        self._settling = settling
        self._places = command_places(robot)
        self._resting: dict[tuple[int, int], float] = {}
        self._ownership = self._find_ownership(())
        self._unowned_since: dict[str, tuple[int, float]] = {}
        self._cycles = [manager.cycle]
        self._running = [frozenset(info.name for info in manager.running())]
        self._mirrors = [_Mirror(leaf, manager) for leaf in _leaves(robot)]
        write = robot.write

        def watched_write(time: float, period: float) -> None:
            self.look()
            write(time, period)

        robot.write = watched_write  # type: ignore[method-assign]

    def forget_rest(self) -> None:
        """Allow new rest commands without an owner, after a reset of the world."""
        self._resting.clear()
        self._unowned_since.clear()

    def look(self) -> None:
        """Check the present state of the robot; it is called before every `write`."""
        cycle, running = self._manager.cycle, self._manager.running()
        before = self._ownership
        # A robot makes hundreds of cycles between two switches.
        if running != before.running:
            self._ownership = self._find_ownership(running)
        self.find_wrong_commands()
        self._look_at_owners(running)
        self._look_at_rest(before.names)
        self._look_at_joints(cycle)
        if not self._manager.is_switching():
            for mirror in self._mirrors:
                self._note(mirror.difference(running))
        for check in self.checks:
            self._note(check())
        names = frozenset(info.name for info in running)
        if names != self._running[-1]:
            # Append to `_running` first, because `ran_at` reads `_cycles` first.
            self._running.append(names)
            self._cycles.append(cycle)
        self.cycle = cycle

    def ran_at(self, cycle: int) -> frozenset[str]:
        """Return the names of the controllers that ran at the end of a cycle.

        Args:
            cycle: Its number, at most `self.cycle`.
        """
        return self._running[max(bisect_right(self._cycles, cycle) - 1, 0)]

    def untruth(self, result: SwitchResult) -> str | None:
        """Return a false statement in the answer to a switch; None if there is none.

        Args:
            result: The answer; its cycle must have been checked.
        """
        running = self.ran_at(result.cycle)
        start = {info.name for info in result.plan.start}
        stop = {info.name for info in result.plan.stop}
        as_planned = start <= running and not stop & running
        at = f"in cycle {result.cycle} {_names(running)} ran"
        if not {*result.started} <= running:
            return f"said to be started: {_names(result.started)}; {at}"
        if {*result.stopped} & running:
            return f"said to be stopped: {_names(result.stopped)}; {at}"
        if result.ok and not as_planned:
            return f"said to be as planned, +{_names(start)} -{_names(stop)}; {at}"
        if not result.ok and not result.failed:
            return f"said not to be as planned, without a reason; {at}"
        restored = stop - set(result.failed)
        if result.outcome is SwitchOutcome.ROLLED_BACK and not restored <= running:
            return f"said to be rolled back to {_names(restored)}; {at}"
        return None

    def find_wrong_commands(self) -> None:
        """Note every command that is not a finite float."""
        for place in self._places:
            value = place.storage[place.index]
            if type(value) is not float or not math.isfinite(value):
                self._note(f"command {value!r} of {place.claim[1]} is no finite float")

    def _find_ownership(self, running: Sequence[ControllerInfo]) -> _Ownership:
        """Find what controllers own; note every resource with two owners."""
        owners: dict[tuple[str, str], str] = {}
        for info in running:
            for claim in info.claimed_resources:
                for resource in claim.resources:
                    other = owners.setdefault(
                        (claim.hardware_interface, resource), info.name
                    )
                    if other != info.name and not self._may_share:
                        self._note(f"{resource} is owned by {other} and {info.name}")
        owned = frozenset(one.slot for one in self._places if one.claim in owners)
        return _Ownership(
            running,
            frozenset(resource for _, resource in owners),
            owned,
            [place for place in self._places if place.slot not in owned],
        )

    def _look_at_owners(self, running: Sequence[ControllerInfo]) -> None:
        conflicts = self._robot.check_for_conflict(running)
        if conflicts:
            self._note(f"two owners: {conflicts[0].reason}")

    def _look_at_rest(self, owned_before: frozenset[str]) -> None:
        for slot in self._ownership.owned:
            self._resting.pop(slot, None)
        for place in self._ownership.free:
            slot, value = place.slot, place.storage[place.index]
            # A resource that had an owner through any interface may have moved, so its
            # commands may get a new rest. Without an owner they keep their rest.
            before = self._resting.get(slot)
            if value == before:
                continue
            if before is None or place.claim[1] in owned_before:
                self._resting[slot] = value
                rest = place.rest()
                if math.isfinite(rest) and not math.isclose(
                    value, rest, rel_tol=0.0, abs_tol=1e-9
                ):
                    self._note(
                        f"command {value!r} of {place.claim} without an owner does not "
                        f"rest at {rest!r}"
                    )
            else:
                self._note(
                    f"command {place.claim} without an owner changed from "
                    f"{self._resting[slot]!r} to {value!r}"
                )
                self._resting[slot] = value

    def _look_at_joints(self, cycle: int) -> None:
        states = self._robot.get(JointStateInterface)
        if states is None or self._drift == math.inf:
            return
        owned = self._ownership.names
        if owned - {*states.get_names()}:  # e.g. a whole arm
            self._unowned_since.clear()
            return
        for handle in states.handles():
            if handle.name in owned:
                self._unowned_since.pop(handle.name, None)
                continue
            position = handle.get_position()
            since, before = self._unowned_since.setdefault(
                handle.name, (cycle, position)
            )
            if cycle - since <= self._settling:
                self._unowned_since[handle.name] = (since, position)
            elif abs(position - before) > self._drift:
                self._note(
                    f"joint {handle.name} without an owner moved from {before} to "
                    f"{position}"
                )
                self._unowned_since[handle.name] = (cycle, position)

    def _note(self, problem: str | None) -> None:
        if problem is not None and len(self.problems) < MOST_PROBLEMS:
            self.problems.append(f"cycle {self._manager.cycle}: {problem}")


class _Mirror:
    """The running controllers as one robot knows them from `do_switch`.

    Args:
        robot: The robot; it may be part of a combined one.
        manager: The manager.
    """

    def __init__(self, robot: RobotHW, manager: ControllerManager) -> None:
        self._robot = robot
        self._manager = manager
        self._resources = robot.resources()
        self._running: Sequence[ControllerInfo] = manager.running()
        self._known = self._concerned(self._running)
        self._told = set(self._known)
        self._unsure: set[str] = set()
        do_switch = robot.do_switch

        def watched_do_switch(
            start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
        ) -> None:
            names = {info.name for info in (*start, *stop)}
            self._unsure |= names  # when it raises
            do_switch(start, stop)
            self._unsure -= names
            self._told -= {info.name for info in stop}
            self._told |= {info.name for info in start}

        robot.do_switch = watched_do_switch  # type: ignore[method-assign]

    def difference(self, running: Sequence[ControllerInfo]) -> str | None:
        """Return controllers of which the robot has a wrong state, as text, or None.

        Args:
            running: The controllers that run.
        """
        if running != self._running:
            self._running, self._known = running, self._concerned(running)
        wrong = (self._told ^ self._known) - self._unsure
        if not wrong:
            return None
        status = {one.name: one for one in self._manager.list_controllers()}
        # Ignore controllers that claim nothing of this robot, and those whose fault
        # says that they were not released.
        wrong = {
            name
            for name in wrong
            if name not in status
            or (
                self._concerns(status[name].claimed_resources)
                and UNRELEASED not in (status[name].fault or "")
            )
        }
        if not wrong:
            return None
        expected, self._told = self._told, set(self._known)
        faults = {name: status[name].fault for name in wrong & status.keys()}
        return (
            f"the robot was not told what became of {_names(wrong)}: it was told of "
            f"{_names(expected)}, and {_names(self._told)} run; faults: {faults}"
        )

    def _concerned(self, running: Sequence[ControllerInfo]) -> set[str]:
        return {info.name for info in running if self._concerns(info.claimed_resources)}

    def _concerns(self, claims: Sequence[InterfaceResources]) -> bool:
        return any(self._resources.intersection(claim.resources) for claim in claims)


def command_places(robot: RobotHW) -> list[CommandPlace]:
    """Return every command of every interface of a robot.

    Args:
        robot: The robot, initialised.
    """
    places: list[CommandPlace] = []
    for interface_type in robot.interface_types():
        interface: object | None = robot.get(interface_type)
        if not isinstance(interface, HardwareResourceManager):
            continue
        type_name = interface_type_name(interface_type)
        for handle in interface.handles():
            origin, name = interface.origin(handle.name), handle.name
            places.extend(
                CommandPlace(
                    (type_name, name),
                    storage,
                    index,
                    lambda o=origin, n=name, p=position: o.rest_commands(n)[p],  # type: ignore[misc]
                )
                for position, (storage, index) in enumerate(handle.command_slots())
            )
    return places


def _leaves(robot: RobotHW) -> list[RobotHW]:
    if not isinstance(robot, CombinedRobotHW):
        return [robot]
    return [leaf for part in robot.robots.values() for leaf in _leaves(part)]


def _names(names: Sequence[str] | set[str] | frozenset[str]) -> str:
    return ", ".join(sorted(names)) or "nobody"
