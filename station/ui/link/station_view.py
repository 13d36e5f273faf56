"""The dashboard's knowledge of the station at one moment, and the recovery it asks for.

The knowledge is frozen data.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from station import wire
from station.core.description.urdf import Pose, Vector3
from station.wire import ArmReport

_IDENTITY = (*(1.0, 0.0, 0.0, 0.0, 0.0) * 3, 1.0)

ARM_FIELDS = ("F_T_EE", "EE_T_K", "O_T_EE", "O_F_ext_hat_K")
"""Fields of an arm's state that `arm_facts` reads."""
_NOTHING_MOVES = "Nothing moves by itself; controllers stay stopped."
_MOST_ERRORS = 3


@dataclass(frozen=True, slots=True)
class ArmFacts:
    """The tool of a Franka arm.

    Attributes:
        flange_to_tool: Pose of EE in the flange frame.
        tool_to_stiffness: Pose of K in EE.
        force: Force on the robot at K, in the axes of its base [N]; None while unknown.
        tool: Pose of EE in the frame of the base; None while unknown.
    """

    flange_to_tool: Pose
    tool_to_stiffness: Pose
    force: Vector3 | None
    tool: Pose | None = None


def arm_facts(state: Mapping[str, object]) -> ArmFacts:
    """Return the tool of an arm and the force on it.

    Args:
        state: The fields of `FrankaState` that `ARM_FIELDS` names.
    """
    wrench = _numbers(state, "O_F_ext_hat_K", 6)
    place = _numbers(state, "O_T_EE", 16)
    # The arm reports the wrench that it exerts; the opposite acts on it.
    force = None if wrench is None else (-wrench[0], -wrench[1], -wrench[2])
    return ArmFacts(
        pose_of(_numbers(state, "F_T_EE", 16) or _IDENTITY),
        pose_of(_numbers(state, "EE_T_K", 16) or _IDENTITY),
        force,
        None if place is None else pose_of(place),
    )


def _numbers(
    state: Mapping[str, object], name: str, count: int
) -> tuple[float, ...] | None:
    """Return an array of a state; None where it is missing or not finite."""
    values = state.get(name)
    if not isinstance(values, Sequence) or len(values) != count:
        return None
    numbers = tuple(value for value in values if isinstance(value, (int, float)))
    return numbers if len(numbers) == count else None


def pose_of(matrix: Sequence[float]) -> Pose:
    """Return the pose of a homogeneous matrix in column-major order, shape (16,).

    The quaternion comes from the trace or, where that is small, from the largest
    element of the diagonal (Shepperd's method), so that no division loses digits.
    """
    m = matrix
    xx, yx, zx, xy, yy, zy, xz, yz, zz = (*m[0:3], *m[4:7], *m[8:11])
    squares = (1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    four = 2.0 * math.sqrt(max(squares[largest], 1e-12))
    rows = (
        (four * four / 4, zy - yz, xz - zx, yx - xy),
        (zy - yz, four * four / 4, xy + yx, xz + zx),
        (xz - zx, xy + yx, four * four / 4, yz + zy),
        (yx - xy, xz + zx, yz + zy, four * four / 4),
    )
    w, x, y, z = (part / four for part in rows[largest])
    return Pose((m[12], m[13], m[14]), (w, x, y, z))


STALE_AFTER = 0.7
"""Data older than this must not be taken for the present [s]."""
LOST_AFTER = 3.0
"""Data older than this means that the link is down [s]."""

TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
"""Elements of the set-point of a controller that jogs an end effector."""
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
"""Elements of the set-point of a controller that moves an end effector to a pose."""
POSITION_UNITS = frozenset({"rad", "m"})
Limits = Mapping[str, tuple[float, float]]
"""Lowest and highest position of joints by name [rad] or [m]."""
_NO_LIMITS: Limits = MappingProxyType({})
_NO_POSITIONS: Mapping[str, float] = MappingProxyType({})
_NO_ELEMENTS: Mapping[str, tuple[wire.CommandElement, ...]] = MappingProxyType({})
_NO_MESSAGES: Mapping[str, str] = MappingProxyType({})
_NO_ARMS: Mapping[str, ArmFacts] = MappingProxyType({})
_NO_SAMPLES: Mapping[str, wire.ControllerSample] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class StationView:
    """The newest values of the station that the dashboard has received.

    Attributes:
        now: Monotonic time at which this view was made [s].
        heard_at: Time of the station's last message, on the same clock [s]; None
            before.
        failure: Reason why the last request failed; empty when it did not.
        status: The station at a glance; None before the first answer.
        controllers: All loaded controllers.
        types: Controller types that can be loaded.
        positions: Joint positions by name [rad] or [m].
        elements: The set-points that running controllers take, by controller.
        samples: The last samples of watched controllers, by controller.
        messages: Why a motion of an end effector waits or slows down, by controller.
        sliding: The drawn joints whose positions are lengths.
        limits: Position limits that the robot keeps; joints without limits are left
            out.
        arms: The tools of the Franka arms and the forces on them, by arm_id.
        base: Pose of a floating or driving base; None without one.
        objects: The objects around a simulated robot with their last known poses.
        contacts: The points at which bodies of a simulated world touch; empty while no
            browser shows them.
    """

    now: float = 0.0
    heard_at: float | None = None
    failure: str = ""
    status: wire.Status | None = None
    controllers: tuple[wire.ControllerState, ...] = ()
    types: tuple[wire.ControllerType, ...] = ()
    positions: Mapping[str, float] = field(default_factory=lambda: _NO_POSITIONS)
    elements: Mapping[str, tuple[wire.CommandElement, ...]] = field(
        default_factory=lambda: _NO_ELEMENTS
    )
    samples: Mapping[str, wire.ControllerSample] = field(
        default_factory=lambda: _NO_SAMPLES
    )
    messages: Mapping[str, str] = field(default_factory=lambda: _NO_MESSAGES)
    sliding: frozenset[str] = frozenset()
    limits: Limits = field(default_factory=lambda: _NO_LIMITS)
    arms: Mapping[str, ArmFacts] = field(default_factory=lambda: _NO_ARMS)
    base: wire.MovingBase | None = None
    objects: tuple[wire.SceneObject, ...] = ()
    contacts: tuple[wire.Contact, ...] = ()

    @property
    def age(self) -> float | None:
        """Age of the newest data [s]; None before the first."""
        return None if self.heard_at is None else max(self.now - self.heard_at, 0.0)

    @property
    def link(self) -> str:
        """State of the link: `live`, `stale` or `lost`."""
        age = self.age
        if age is None or age > LOST_AFTER:
            return "lost"
        # One late frame is no reason to grey the page.
        return "stale" if age > STALE_AFTER else "live"

    @property
    def epoch(self) -> int | None:
        """The station's epoch; None while it is not known."""
        return None if self.status is None else self.status.epoch

    @property
    def is_stopped(self) -> bool:
        """Return whether the stop is engaged, or released without motion allowed."""
        return self.status is not None and self.status.stop_state != "armed"

    def arms_of(self, controller: wire.ControllerState) -> tuple[str, ...]:
        """Return the arms that a controller claims, whole or some of their joints."""
        claimed = resources_of(controller)
        arms = () if self.status is None else self.status.robots
        return tuple(
            arm.arm_id
            for arm in arms
            if f"{arm.arm_id}_robot" in claimed
            or any(name.startswith(f"{arm.arm_id}_joint") for name in claimed)
        )

    def commanding_positions(self) -> set[str]:
        """Return the running controllers that command positions of joints."""
        return {
            controller.name
            for controller in self.controllers
            if controller.state == "running"
            and (
                _moves_to_positions(self.elements.get(controller.name, ()))
                or controller.type.endswith("JointTrajectoryController")
            )
        }

    def commanded_positions(self) -> dict[str, float]:
        """Return the commanded positions of joints by name [rad] or [m].

        Only watched controllers have samples, from which these positions come.
        """
        wanted: dict[str, float] = {}
        for name in self.commanding_positions():
            sample = self.samples.get(name)
            if sample is None or len(sample.desired) != len(sample.name):
                continue
            values = zip(sample.name, sample.desired, strict=True)
            wanted |= {joint: value for joint, value in values if value is not None}
        return wanted

    def set_point_of(self, name: str, count: int) -> list[float] | None:
        """Return the last set-point of a watched controller; None while unknown.

        Args:
            name: The controller.
            count: How many numbers its set-point has.
        """
        sample = self.samples.get(name)
        if sample is None or len(sample.desired) != count:
            return None
        known = [value for value in sample.desired if value is not None]
        return known if len(known) == count else None

    def blocked(self) -> str:
        """Return the reason why the robot takes no commands; empty if it takes them."""
        if self.link != "live":
            return f"The link to the station is {self.link}."
        if self.status is None:
            return "The state of the station is not known yet."
        if self.status.stop_state == "stopped":
            return "The robot is stopped. Release the stop and allow motion first."
        if self.status.stop_state == "released":
            return "The stop is released, but motion is not allowed yet."
        return ""


def moves_hand(elements: Sequence[wire.CommandElement]) -> bool:
    """Return whether a set-point is a pose or a velocity of an end effector."""
    return bool(elements) and elements[0].name in {TWIST[0], POSE[0]}


def moves_joints(elements: Sequence[wire.CommandElement]) -> bool:
    """Return whether a set-point has one number per joint."""
    return bool(elements) and not moves_hand(elements)


def resources_of(controller: wire.ControllerState) -> frozenset[str]:
    """Return the resources that a controller claims."""
    return frozenset(
        resource
        for claim in controller.claimed_resources
        for resource in claim.resources
    )


def _moves_to_positions(elements: Sequence[wire.CommandElement]) -> bool:
    in_position = all(element.unit in POSITION_UNITS for element in elements)
    return moves_joints(elements) and in_position


@dataclass(frozen=True, slots=True)
class Recovery:
    """The present action of the recovery button.

    Attributes:
        action: `recover` all arms, `release` the user stops of `arms`, or an empty text
            when there is nothing to do.
        label: Text of the button.
        arms: The arms with an error or a pressed user stop.
        trouble: The errors, for people; empty without an error.
        reason: The effect of the button, or the reason why it is disabled.
    """

    action: Literal["recover", "release", ""] = ""
    label: str = "Recover"
    arms: tuple[str, ...] = ()
    trouble: str = ""
    reason: str = "Nothing to recover: no arm has an error."


def choose_recovery(view: StationView) -> Recovery:
    """Return the recovery that the arms of a station need, if any."""
    if view.link != "live" or view.status is None:
        return Recovery(reason=view.blocked())
    arms = view.status.robots
    stopped = _in_mode(arms, "user_stopped")
    if stopped:
        names = _names(stopped)
        return Recovery(
            "release",
            f"Release the user stop of {names}",
            tuple(arm.arm_id for arm in stopped),
            f"The user stop of {names} is pressed.",
            f"Releases it and clears the errors. {_NOTHING_MOVES}",
        )
    erroneous = _in_mode(arms, "reflex")
    if erroneous:
        names = _names(erroneous)
        return Recovery(
            "recover",
            f"Recover {names}",
            tuple(arm.arm_id for arm in erroneous),
            "; ".join(_trouble(arm) for arm in erroneous),
            f"Remove the cause first. Clears the errors; {names} goes to idle and "
            f"holds its pose. {_NOTHING_MOVES}",
        )
    helpless = [arm for arm in arms if arm.remedy]
    if helpless:
        reason = "; ".join(f"{arm.arm_id}: {arm.remedy}" for arm in helpless)
        modes = [f"{arm.arm_id} is in mode {arm.robot_mode}." for arm in helpless]
        reason = f"No recovery from here: {reason}."
        return Recovery(trouble=" ".join(modes), reason=reason)
    return Recovery()


def _in_mode(arms: Sequence[ArmReport], mode: str) -> list[ArmReport]:
    return [arm for arm in arms if arm.robot_mode == mode]


def _names(arms: Sequence[ArmReport]) -> str:
    return " and ".join(arm.arm_id for arm in arms)


def _trouble(arm: ArmReport) -> str:
    errors = [error.description for error in arm.errors[:_MOST_ERRORS]]
    more = len(arm.errors) - len(errors)
    if more > 0:
        errors.append(f"{more} more")
    return f"{arm.arm_id} stopped itself: {', '.join(errors) or 'an error'}"
