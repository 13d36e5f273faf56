"""Certificates: a command is carried out as it was rehearsed, or the station stops."""

import json
import secrets
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from typing_extensions import override

from station.core.control.controller import ControllerBase
from station.core.errors import (
    CertificateNotFoundError,
    CertificateVoidError,
)
from station.core.hardware.robot_report import SceneObjectReport
from station.core.loop.cycle_tap import CycleTap
from station.core.loop.snapshot import HEAD
from station.core.ports.command_ticket import CommandTicket
from station.reports import Certificate

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from station.core.facade.station import Station

VALID_FOR = 180.0
"""How long a certificate is valid [s wall time]. A person may take a minute to allow an
agent's command, and all conditions are checked again when the command is given."""
MOST = 32
"""Most certificates that are kept; the oldest are dropped first."""
_SCENE_TOLERANCE = 0.002
"""How far an object may be from its pose at the rehearsal [m]; for each number of the
pose."""
_MOTIONS = frozenset({"set_point", "goal", "trajectory", "path"})
_AT_REST = 0.1
"""How much the velocity of a joint may differ from that at the rehearsal [rad/s or
m/s]."""


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Largest distances of the robot from a rehearsed motion.

    Attributes:
        pose: Distance of each joint at the beginning [rad or m], > 0.
        tube: Distance of each joint during the motion [rad or m], > 0.
    """

    pose: float = 0.01
    tube: float = 0.03


@dataclass(frozen=True, slots=True)
class Conditions:
    """The conditions under which a rehearsal began.

    Attributes:
        epoch: The station's epoch.
        changes: Number of changes of settings since the station's start.
        running: Names of the controllers that ran.
        gains: Gains by controller and name.
        scene: Pose of each object around the robot, by the report of the object without
            its pose.
        position: Positions of the joints [rad or m] by name.
        velocity: Velocities of the joints [rad/s or m/s] by name.
    """

    epoch: int
    changes: int
    running: frozenset[str]
    gains: Mapping[str, Mapping[str, float]]
    scene: Mapping[SceneObjectReport, Sequence[float]]
    position: Mapping[str, float]
    velocity: Mapping[str, float]

    @classmethod
    def of(cls, station: "Station") -> "Conditions":
        """Return the present conditions of a station.

        Raises:
            LoopError: The loop died or hangs, or no cycle has run yet.
        """
        now, names = station.latest(), station.joint_names
        gate = station.manager.controller_update.gate
        return cls(
            station.epoch,
            station.inputs.changes,
            frozenset(one.info.name for one in gate.running),
            station.tuning.all_gains(),
            {
                replace(one, position=(), orientation=(), colour=()): (
                    *one.position,
                    *one.orientation,
                )
                for one in station.scene()
            },
            dict(zip(names, now.position, strict=True)),
            dict(zip(names, now.velocity, strict=True)),
        )

    def changed(self, now: "Conditions", last_change: str) -> str | None:
        """Return a sentence about a change that is not a motion of joints, or None.

        Args:
            now: The present conditions.
            last_change: Kind of the last change of a setting.
        """
        if now.epoch != self.epoch:
            return f"The epoch was {self.epoch} and is {now.epoch}."
        if now.running != self.running:
            names = ", ".join(sorted(now.running ^ self.running))
            return f"Other controllers run: {names}."
        for name, values in self.gains.items():
            for key, value in values.items():
                present = now.gains.get(name, {}).get(key)
                if present != value:
                    return f"The gain {key} of '{name}' was {value} and is {present}."
        for thing in self.scene.keys() ^ now.scene.keys():
            return f"The object '{thing.name}' was added, removed or changed."
        for thing, pose in self.scene.items():
            far = max(abs(a - b) for a, b in zip(pose, now.scene[thing], strict=True))
            if far > _SCENE_TOLERANCE:
                return f"The object '{thing.name}' has moved."
        if now.changes != self.changes:
            return f"The station has changed; the last change was: {last_change}."
        return None

    def moved(self, now: "Conditions", tolerance: float) -> str | None:
        """Return a sentence about a joint that is too far away, or None."""
        for joint, q in self.position.items():
            far = abs(now.position[joint] - q)
            if far > tolerance:
                return (
                    f"{joint} was at {q:.4f} and is at {now.position[joint]:.4f}; "
                    f"allowed is a difference of {tolerance:g}."
                )
            if abs(now.velocity[joint] - self.velocity[joint]) > _AT_REST:
                return f"{joint} moves at {now.velocity[joint]:.3f}."
        return None


class Tube(CycleTap[None]):
    """Stops the station when joints leave the rehearsed motion.

    It stops watching when the motion ends, the epoch changes, or the controller gets
    another command. A set-point that has no end is watched while it is in force.

    Args:
        station: The station.
        promised: Positions after each cycle of the motion [rad or m], shape (k, n).
        joints: Indices of the joints to watch.
        width: How far each joint may be from the motion [rad or m].
        controller: The controller that is commanded; empty for none.
        follower: The controller if the command is a set-point.

    Attributes:
        is_over: Whether it has stopped watching.
    """

    def __init__(
        self,
        station: "Station",
        promised: "NDArray[np.float64]",
        joints: Sequence[int],
        width: float,
        controller: str,
        follower: ControllerBase | None,
    ) -> None:
        super().__init__(station.loop, lambda: None)
        self.is_over = False
        self._station = station
        self._ring = station.snapshots
        self._promised = promised.tolist()
        self._joints = tuple(joints)
        self._width = width
        self._controller = controller
        self._follower = follower
        self._set_point: list[float] | None = None
        self._ticket: CommandTicket | None = None
        self._commands: int | None = None
        self._epoch = station.epoch
        self._begin: float | None = None

    def expect(self, ticket: CommandTicket) -> None:
        """Watch from the cycle that takes a command; call this before the command.

        Args:
            ticket: Notes the cycle that takes the command.
        """
        self._ticket = ticket
        self.open()

    def follow(self) -> None:
        """Note that the command was given: a further command ends the tube."""
        self._commands = self._station.inputs.commands.get(self._controller)
        self._set_point = self._set_point_in_force()

    def _set_point_in_force(self) -> list[float] | None:
        """Return the set-point that the controller follows, or None."""
        one = self._follower
        if one is None or one.set_points is None or not one.is_running():
            return None
        return one.set_points.newest

    @override
    def sample_cycle(self, cycle: int, epoch: int, stamp: float, period: float) -> None:
        """Compare a cycle with the motion. Only the control thread calls it."""
        ticket, commands = self._ticket, self._commands
        if self.is_over or ticket is None or ticket.accepted_cycle is None:
            return
        now = self._station.inputs.commands.get(self._controller)
        if epoch != self._epoch or (commands is not None and now != commands):
            self.is_over = True
            return
        if self._begin is None:
            self._begin = stamp
        # A late cycle has a longer period, so find the place in the motion by time, not
        # by counting cycles.
        k = int((stamp - self._begin) / self._station.loop.period + 0.5)
        if k >= len(self._promised):
            # A slow set-point seems to rest, and would go on for ever unwatched.
            in_force = self._set_point_in_force()
            if in_force is None or in_force is not self._set_point:
                self.is_over = True
                return
            k = -1
        ring, promised, width = self._ring, self._promised[k], self._width
        at = (cycle % ring.capacity) * ring.width + HEAD
        for i in self._joints:
            far = abs(ring.memory[at + i] - promised[i])
            if not far <= width:
                self.is_over = True
                name = self._station.joint_names[i]
                self._station.stop_from_cycle(
                    f"{name} is {far:.4f} off the rehearsed motion in cycle {cycle}; "
                    f"allowed is {width:g}"
                )
                return


@dataclass(slots=True)
class _Issued:
    conditions: Conditions
    commands: list[str]
    tube: Tube
    deadline: float
    is_bounded: bool
    lock: threading.Lock = field(default_factory=threading.Lock)


class Certificates:
    """The certificates of a station. Any thread.

    Args:
        station: The station.
        tolerances: Largest distances of the robot from the rehearsed motion.
    """

    def __init__(self, station: "Station", tolerances: Tolerances) -> None:
        self._station = station
        self._tolerances = tolerances
        self._issued: dict[str, _Issued] = {}
        self._tube: Tube | None = None

    def issue(
        self,
        steps: Sequence[Mapping[str, Any]],
        conditions: Conditions,
        positions: "NDArray[np.float64]",
        *,
        is_bounded: bool = False,
    ) -> Certificate | None:
        """Return a certificate for commands that were rehearsed.

        Args:
            steps: The commands; all must come at the beginning.
            conditions: State of the station at the beginning of the rehearsal.
            positions: Positions of all joints after every cycle [rad or m], (k, n).
            is_bounded: Whether the motion keeps to the envelope of agents.

        Returns:
            The certificate; None unless the steps are switches and one motion at the
            end, all at the beginning, and for a path that begins again at its end.
        """
        # Each command is given by itself: the first of two motions, alone, would be
        # another motion than both together.
        *before, last = steps or [{"kind": ""}]
        is_later = any(float(step["at"]) > 0.0 for step in steps)
        if is_later or last["kind"] not in _MOTIONS:
            return None
        if last.get("options", {}).get("loop") or any(
            one["kind"] != "switch" for one in before
        ):
            return None
        names = [str(step["name"]) for step in steps if "name" in step]
        controller = names[-1] if names else ""
        follower = None
        if last["kind"] == "set_point":
            follower = self._station.manager.get_controller(controller)
        tube = Tube(
            self._station,
            positions,
            self._joints_of(names),
            self._tolerances.tube,
            controller,
            follower,
        )
        name = secrets.token_urlsafe(12)
        now = self._station.loop.clock.now()
        for old in [k for k, one in self._issued.items() if one.deadline < now]:
            self._issued.pop(old, None)
        while len(self._issued) >= MOST:
            self._issued.pop(next(iter(self._issued)), None)
        self._issued[name] = _Issued(
            conditions,
            [command_text(step) for step in steps],
            tube,
            now + VALID_FOR,
            is_bounded,
        )
        return Certificate(name, VALID_FOR, self._tolerances.tube)

    @contextmanager
    def redeem(
        self, name: str, command: Mapping[str, Any], *, is_agent: bool = False
    ) -> Iterator[CommandTicket]:
        """Let a rehearsed command be given in the body of a `with`.

        The commands of a certificate must be given in their order, each once. The body
        gives the command, with the ticket that this method yields.

        Args:
            name: The certificate.
            command: The command, as a step of a rehearsal.
            is_agent: Whether an agent gives the command.

        Raises:
            CertificateNotFoundError: The certificate does not exist, or has expired.
            CertificateVoidError: The certificate is for another command or not for
                agents, or a condition of the rehearsal has changed; nothing moves.
            LoopError: The loop died or hangs.
        """
        issued = self._find(name, is_agent=is_agent)
        with issued.lock:
            self._check(issued, command)
            ticket, is_last = self._station.motion.ticket(), len(issued.commands) == 1
            if is_last:
                self._watch(issued.tube, ticket)
            try:
                yield ticket
            except BaseException:
                # The command was refused, so there is no motion to watch.
                issued.tube.close()
                raise
            del issued.commands[0]
            # The changes by the command itself were rehearsed, so they become
            # conditions.
            issued.conditions = Conditions.of(self._station)
            if is_last:
                issued.tube.follow()
                self._issued.pop(name, None)

    def _watch(self, tube: Tube, ticket: CommandTicket) -> None:
        """Replace the tube that is watched."""
        if self._tube is not None:
            self._tube.close()
        self._tube = tube
        tube.expect(ticket)

    def _check(self, issued: _Issued, command: Mapping[str, Any]) -> None:
        if not issued.commands or issued.commands[0] != command_text(command):
            raise CertificateVoidError(
                "The certificate is for another command than this one.",
                remedy="Give the commands as they were rehearsed, in their order.",
                details={
                    "rehearsed": issued.commands[0] if issued.commands else None,
                    "given": command_text(command),
                },
            )
        self._check_conditions(issued)

    def check(self, name: str) -> None:
        """Refuse an agent's certificate that is no longer valid for any command.

        Args:
            name: The certificate.

        Raises:
            CertificateNotFoundError: The certificate does not exist, or has expired.
            CertificateVoidError: The certificate is not for agents, or a condition of
                the rehearsal has changed.
            LoopError: The loop died or hangs.
        """
        issued = self._find(name, is_agent=True)
        with issued.lock:
            self._check_conditions(issued)

    def _find(self, name: str, *, is_agent: bool) -> _Issued:
        issued = self._issued.get(name)
        if issued is None or self._station.loop.clock.now() > issued.deadline:
            raise CertificateNotFoundError(
                f"There is no certificate '{name}', or it was used or has expired.",
                remedy="Rehearse the command, and give it within "
                f"{VALID_FOR:g} s with the certificate of the answer.",
            )
        if is_agent and not issued.is_bounded:
            raise CertificateVoidError(
                "The certificate was made for a person, whose motions need not keep to "
                "the envelope of agents.",
                remedy="Rehearse the command with the agent's token.",
            )
        return issued

    def _check_conditions(self, issued: _Issued) -> None:
        now = Conditions.of(self._station)
        why = issued.conditions.changed(now, self._station.inputs.last_change)
        why = why or issued.conditions.moved(now, self._tolerances.pose)
        if why is not None:
            raise CertificateVoidError(
                f"The certificate is void: {why}",
                remedy="Rehearse the command again.",
                details={"reason": why},
            )

    def _joints_of(self, names: Sequence[str]) -> list[int]:
        """Return the indices of the joints that controllers move; all if unknown."""
        moved: set[str] = set()
        for name in names:
            moved |= set(self._station.manager.get_controller(name).joint_names)
        known = self._station.joint_names
        # Controllers of the hand's pose have elements that are not joints, and move the
        # whole arm.
        moved &= set(known)
        return [i for i, joint in enumerate(known) if not moved or joint in moved]


def command_text(command: Mapping[str, Any]) -> str:
    """Return a command as text; equal commands have equal texts."""
    untimed = {key: value for key, value in command.items() if key != "at"}
    return json.dumps(untimed, sort_keys=True, default=str)
