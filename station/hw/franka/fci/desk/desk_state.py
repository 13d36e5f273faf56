"""The state of Desk: who holds control, brakes, FCI, operating mode, end effectors.

Source: the requests of aiofranka 0.9.0 (server.py, client.py, tools.py) and of
franky-control 2.0.0 (desk.py), and the answers that they wait for. The robot's own
interface is not published; where these programs leave an answer open, docs/fci.md says
so.
"""

import secrets
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from itertools import count
from typing import Any, Protocol

from station.core.description.urdf import Pose
from station.core.errors import StationError
from station.core.franka.franka_robot_state import RobotMode
from station.core.numerics.poses import quaternion_of
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.end_effector import as_transform
from station.hw.franka.simulated.simulated_arm import SimulatedArm

EXECUTION, PROGRAMMING = "Execution", "Programming"
NO_END_EFFECTOR = "ee-no-profile"
"""Name of Desk's own profile without an end effector."""
MOUNTED = "ee-mounted"
"""Name of the profile of the end effector that the simulated arm carries."""
LONGEST_WAIT = 60.0
"""Longest wait for control [s]."""
Profile = dict[str, Any]


class DeskRefusalError(StationError):
    """Desk refuses a request, by default because of the state of the robot.

    Args:
        message: The reason in words.
        status: The HTTP status of the answer.
        reason: The code of the answer.
    """

    code = "desk_refusal"

    def __init__(
        self, message: str, status: int = 424, reason: str = "SystemState"
    ) -> None:
        super().__init__(message)
        self.status, self.reason = status, reason


class InvalidArgumentError(DeskRefusalError):
    """A request is malformed.

    Args:
        message: The reason in words.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message, 400, "InvalidArgument")


class ServerOfDesk(Protocol):
    """A server of libfranka's programs, as Desk needs it. Any thread."""

    def change(self, action: Callable[[], None]) -> Future[None]:
        """Carry an action out between two cycles of the arm."""

    def open_or_close(self, *, is_open: bool) -> Future[None]:
        """Let programs of libfranka connect, or send them away and refuse them."""


@dataclass(frozen=True, slots=True)
class ControlToken:
    """The right of one client to operate the robot.

    Attributes:
        number: Its public number.
        secret: Text that proves the token in requests.
        owner: Name of the client.
        since: Time at which the token was asked for [s].
    """

    number: int
    secret: str
    owner: str
    since: float


@dataclass(slots=True)
class Desk:
    """The state of Desk, and its rules. One thread, that of its server.

    The arm and the hand are changed between two cycles, by the server of libfranka's
    programs.

    Attributes:
        server: The server of libfranka's programs.
        arm: The arm.
        hand: The hand; None without a hand.
        kind: Kind of arm, `panda` or `fr3`.
        are_brakes_closed: Whether the joints are locked.
        is_fci_active: Whether programs of libfranka can connect.
        mode: The operating mode.
        active: Name of the active end effector.
        profiles: The end effectors by their names, those of Desk among them.
        token: The token in force; None when no client has control.
        waiting: Tokens that were asked for while another client had control.
        now: Monotonic clock [s].
    """

    server: ServerOfDesk
    arm: SimulatedArm
    hand: HandServices | None
    kind: str
    are_brakes_closed: bool = False
    is_fci_active: bool = True
    mode: str = EXECUTION
    active: str = MOUNTED
    profiles: dict[str, Profile] = field(init=False)
    token: ControlToken | None = None
    waiting: list[ControlToken] = field(default_factory=list)
    now: Callable[[], float] = time.monotonic
    _numbers: "count[int]" = field(default_factory=lambda: count(1))

    def __post_init__(self) -> None:
        """Keep the end effector that the arm has."""
        state = self.arm.state
        load = RigidBody(state.m_ee, (*state.F_x_Cee,), (*state.I_ee,))
        nothing = profile_of("No End Effector", RigidBody(), IDENTITY)
        self.profiles = {
            MOUNTED: profile_of("Mounted", load, (*state.F_T_NE,)),
            NO_END_EFFECTOR: {**nothing, "endEffector": "None"},
        }

    def request_control(self, owner: str, *, is_forced: bool = False) -> ControlToken:
        """Return a token, which waits as long as another client has control.

        Args:
            owner: Name of the client.
            is_forced: Whether the token is in force at once; on a real robot a person
                at the arm presses a button for this.
        """
        secret = secrets.token_hex(16)
        token = ControlToken(next(self._numbers), secret, owner, self.now())
        if self.token is None or is_forced:
            self.token = token
        else:
            self.waiting.append(token)
        return token

    def release_control(self, secret: str) -> None:
        """Give a token back; the token that has waited longest comes into force.

        Raises:
            DeskRefusalError: There is no such token.
        """
        if self.token is not None and self.token.secret == secret:
            # Clients of the old interface that give up do not say so.
            begin = self.now() - LONGEST_WAIT
            self.waiting = [one for one in self.waiting if one.since >= begin]
            self.token = self.waiting.pop(0) if self.waiting else None
            return
        left = [one for one in self.waiting if one.secret != secret]
        if len(left) == len(self.waiting):
            self.check_control(secret)
        self.waiting = left

    def check_control(self, secret: str | None) -> None:
        """Refuse a request without the token in force.

        Args:
            secret: The token of the request; None without one.

        Raises:
            DeskRefusalError: `secret` is not that of the token in force.
        """
        if not secret:
            raise DeskRefusalError(
                "The header X-Control-Token is missing.", 400, "MissingControlToken"
            )
        if self.token is None or secret != self.token.secret:
            raise DeskRefusalError(
                "The control token is not the active one.", 423, "InvalidControlToken"
            )

    def set_brakes(self, *, closed: bool) -> Future[None]:
        """Close or open the brakes; opening them ends a reflex, also if they were open.

        An arm with closed brakes is in the mode Other.
        """
        self.are_brakes_closed = closed

        def change() -> None:
            self.arm.simulation().set_brakes(closed=closed)
            if self.arm.state.robot_mode is RobotMode.REFLEX:
                self.arm.automatic_error_recovery()

        return self.server.change(change)

    def set_fci(self, *, active: bool) -> Future[None]:
        """Let programs of libfranka connect, or send them away and refuse them.

        Raises:
            DeskRefusalError: The operating mode is not Execution.
        """
        if active and self.mode != EXECUTION:
            raise DeskRefusalError("FCI needs the operating mode Execution.")
        self.is_fci_active = active
        return self.server.open_or_close(is_open=active)

    def change_mode(self, mode: str) -> Future[None] | None:
        """Change the operating mode; Programming deactivates FCI.

        Raises:
            InvalidArgumentError: There is no such mode.
        """
        wanted = mode.capitalize()
        if wanted not in (EXECUTION, PROGRAMMING):
            raise InvalidArgumentError(f"{mode!r} is no operating mode.")
        self.mode = wanted
        return self.set_fci(active=False) if wanted == PROGRAMMING else None

    def reboot(self) -> Future[None]:
        """Begin anew: brakes closed, FCI off, control free."""
        self.token, self.mode = None, EXECUTION
        self.waiting.clear()
        self.set_fci(active=False)
        return self.set_brakes(closed=True)

    def home_gripper(self) -> Future[None]:
        """Begin the homing of the hand, if there is one."""
        home = (lambda: None) if self.hand is None else self.hand.homing
        return self.server.change(home)

    def find_profile(self, name: str) -> Profile:
        """Return an end effector.

        Raises:
            DeskRefusalError: No profile has the name.
        """
        if name not in self.profiles:
            raise DeskRefusalError(f"There is no profile {name!r}.", 404, "NotFound")
        return {**self.profiles[name], "id": name, "active": name == self.active}

    def save_profile(self, name: str | None, profile: Profile) -> Profile:
        """Keep an end effector, under a new name if none is given; return it.

        Raises:
            DeskRefusalError: The profile is Desk's own, or it is not complete.
        """
        self._check_own(name)
        load_of(profile)
        if name is None:
            name = f"ee-{next(self._numbers)}"
        else:
            self.find_profile(name)
        self.profiles[name] = dict(profile)
        return self.find_profile(name)

    def delete_profile(self, name: str) -> None:
        """Forget an end effector.

        Raises:
            DeskRefusalError: No profile has the name, it is Desk's own, or it is
                active.
        """
        self.find_profile(name)
        self._check_own(name)
        if name == self.active:
            raise DeskRefusalError("The profile is active.")
        del self.profiles[name]

    def activate_profile(self, name: str) -> Future[None]:
        """Make an end effector the active one.

        Raises:
            DeskRefusalError: No profile has the name.
        """
        load, frame = load_of(self.find_profile(name))

        def mount() -> None:
            self.arm.set_mounted(load, frame)  # refused while the arm moves
            self.active = name

        return self.server.change(mount)

    def _check_own(self, name: str | None) -> None:
        if name in (NO_END_EFFECTOR, MOUNTED):
            raise DeskRefusalError(f"The profile {name!r} is Desk's own.")


# Largest number of an end effector, in metres, kilograms and radians.
_LARGEST = 1000.0
_AXES = ("x", "y", "z")
_TENSOR = ("x11", "x12", "x13", "x12", "x22", "x23", "x13", "x23", "x33")
# The parts of a profile, and the names of the numbers in each.
_NUMBERS = (
    ("inertial", "centerOfMass", _AXES),
    ("inertial", "inertia", _TENSOR),
    ("tcp", "translation", _AXES),
    ("tcp", "rotation", ("roll", "pitch", "yaw")),
)


def _number(told: Any, lowest: float = -_LARGEST) -> float:  # noqa: ANN401 - of JSON
    number = float(told)
    if not lowest <= number <= _LARGEST:
        raise ValueError(f"{number} is not from {lowest:g} to {_LARGEST:g}")
    return number


def load_of(profile: Mapping[str, Any]) -> tuple[RigidBody, tuple[float, ...]]:
    """Return mass properties and F_T_NE of a profile.

    Raises:
        InvalidArgumentError: A number is missing, or malformed.
    """
    try:
        center, tensor, (x, y, z), (roll, pitch, yaw) = (
            tuple(_number(profile[part][name][key]) for key in keys)
            for part, name, keys in _NUMBERS
        )
        load = RigidBody(_number(profile["inertial"]["mass"], 0.0), center, tensor)
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidArgumentError(
            f"The end effector is not complete or not possible: {error}."
        ) from error
    return load, as_transform(Pose.from_rpy((x, y, z), (roll, pitch, yaw)))


def profile_of(name: str, load: RigidBody, frame: tuple[float, ...]) -> Profile:
    """Return a profile; see `load_of`."""
    x, y, z, w = quaternion_of(frame)
    angles = Pose(quaternion=(w, x, y, z)).rpy()
    values = load.center_of_mass, load.inertia, frame[12:15], angles
    profile: Profile = {"name": name, "deviceId": "ee-no-gripper", "tcp": {}}
    profile["inertial"] = {"mass": load.mass}
    for (part, key, names), numbers in zip(_NUMBERS, values, strict=True):
        profile[part][key] = dict(zip(names, numbers, strict=True))
    return profile
