"""The arm's Cartesian interfaces: command buffers, handles on them, what is sent.

Source: libfranka@0.9.2 src/control_loop.cpp, convertMotion; src/lowpass_filter.cpp,
cartesianLowpassFilter; src/rate_limiting.cpp, limitRate.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, sqrt

from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.rigid_motion import displace, rotation_between, twist_between
from station.hw.franka.arm.arm_limits import ArmLimits, MotionLimits
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.pose_bridge import PoseBridge
from station.hw.franka.commands.rate_limiter import (
    MAX_CUTOFF_FREQUENCY,
    PERIOD,
    RateLimits,
    limit_position,
    low_pass,
    with_margins,
)

# libfranka's margin for the rotation of a pose.
_ROTATION_SHARE = 0.99
_TINY = 1e-15


class CartesianCommands:
    """Cartesian command handles of one arm, and its filter and limits for them.

    Args:
        arm: The arm.
        arm_id: Prefix of its names.
        limits: Its limits.

    Attributes:
        has_pose: Whether pose commands are taken.
        has_twist: Whether twist commands are taken.
    """

    def __init__(self, arm: RobotArm, arm_id: str, limits: ArmLimits) -> None:
        self._arm = arm
        self._pose = list(IDENTITY)
        self._twist = [0.0] * 6
        self._pose_elbow = [0.0, 0.0]
        self._bridge = PoseBridge()
        self._twist_elbow = [0.0, 0.0]
        self.has_pose = self.has_twist = False
        losses = limits.tolerated_losses
        self._translation = with_margins(limits.translation, losses)
        self._rotation = with_margins(limits.rotation, losses)
        elbow = with_margins(
            replace(limits.elbow, velocity=limits.limiter_elbow_velocity), losses
        )
        self._elbow = RateLimits(elbow.velocity, elbow.acceleration, elbow.jerk, 1.0)
        self._filters_first_pose = limits.filters_first_pose
        self._is_first = False
        name, state, refresh = f"{arm_id}_robot", arm.state, arm.refresh_state
        self._pose_interface = FrankaPoseCartesianInterface()
        self._pose_interface.register_handle(
            FrankaCartesianPoseHandle(
                name, state, refresh, self._pose, self._pose_elbow
            )
        )
        self._twist_interface = FrankaVelocityCartesianInterface()
        self._twist_interface.register_handle(
            FrankaCartesianVelocityHandle(
                name, state, refresh, self._twist, self._twist_elbow
            )
        )

    def interfaces(
        self,
    ) -> list[FrankaPoseCartesianInterface | FrankaVelocityCartesianInterface]:
        """Return the interfaces that controllers may ask for."""
        return [self._pose_interface, self._twist_interface]

    def begin(self, mode: ControlMode) -> None:
        """Take commands of the kinds in `mode` from now on, seeded with rest."""
        self.has_pose = bool(mode & ControlMode.CARTESIAN_POSE)
        self.has_twist = bool(mode & ControlMode.CARTESIAN_VELOCITY)
        if self.has_pose:
            self._arm.refresh_state()
            self._pose[:] = self._arm.state.O_T_EE_d
        self._twist[:] = [0.0] * 6
        self._pose_elbow[:] = self._twist_elbow[:] = [0.0, 0.0]
        self._bridge.begin(self._pose, self._arm.state.elbow_d)
        self._is_first = True

    def are_finite(self) -> bool:
        """Return whether all commands that are taken are finite."""
        if not self.has_pose and not self.has_twist:
            return True
        total = 0.0
        if self.has_pose:
            total += sum(self._pose) + sum(self._pose_elbow)
        if self.has_twist:
            total += sum(self._twist) + sum(self._twist_elbow)
        return isfinite(total)

    def send(self, settings: CommandSettings, *, is_new: bool) -> None:
        """Filter, limit and send what is taken.

        Args:
            settings: Cutoff frequency and whether to limit.
            is_new: Whether controllers have updated since the last call.

        Raises:
            InvalidCommandError: The elbow's sign is not +1 or -1.
        """
        state = self._arm.state
        if self.has_pose:
            if self._is_first and not self._filters_first_pose:
                settings = replace(settings, cutoff_frequency=MAX_CUTOFF_FREQUENCY)
            self._is_first = False
            bridge = self._bridge
            pose, bent = (
                bridge.pass_on(self._pose, self._pose_elbow)
                if is_new
                else bridge.bridge()
            )
            pose = self._limited_pose(pose, state, settings)
            elbow = self._limited_elbow(bent, state, settings)
            self._arm.command_cartesian_pose(pose, elbow)
        if self.has_twist:
            twist = self._limited_twist(state, settings)
            elbow = self._limited_elbow(self._twist_elbow, state, settings)
            self._arm.command_cartesian_velocity(twist, elbow)

    def _limited_pose(
        self, pose: list[float], state: RobotState, settings: CommandSettings
    ) -> list[float]:
        if settings.cutoff_frequency < MAX_CUTOFF_FREQUENCY:
            gain = low_pass(1.0, 0.0, settings.cutoff_frequency)
            last = state.O_T_EE_c
            turn = [gain * value for value in rotation_between(last, pose)]
            shift = [gain * (pose[i] - last[i]) for i in (12, 13, 14)]
            pose = displace(last, shift, turn)
        if not settings.rate_limiting:
            return pose
        twist = twist_between(state.O_T_EE_c, pose, PERIOD)
        limited = self._limit(twist, state, _ROTATION_SHARE)
        shift = [value * PERIOD for value in limited[:3]]
        turn = [value * PERIOD for value in limited[3:]]
        return displace(state.O_T_EE_c, shift, turn)

    def _limited_twist(
        self, state: RobotState, settings: CommandSettings
    ) -> list[float]:
        cutoff = settings.cutoff_frequency
        twist = [
            low_pass(value, last, cutoff)
            for value, last in zip(self._twist, state.O_dP_EE_c, strict=True)
        ]
        return self._limit(twist, state, 1.0) if settings.rate_limiting else twist

    def _limit(
        self, twist: Sequence[float], state: RobotState, share: float
    ) -> list[float]:
        v, a = state.O_dP_EE_c, state.O_ddP_EE_c
        rotation = MotionLimits(
            share * self._rotation.velocity,
            share * self._rotation.acceleration,
            share * self._rotation.jerk,
        )
        return [
            *limit_vector(twist[:3], v[:3], a[:3], self._translation),
            *limit_vector(twist[3:], v[3:], a[3:], rotation),
        ]

    def _limited_elbow(
        self, elbow: Sequence[float], state: RobotState, settings: CommandSettings
    ) -> list[float] | None:
        if elbow[0] == 0.0 and elbow[1] == 0.0:
            return None
        angle = low_pass(elbow[0], state.elbow_c[0], settings.cutoff_frequency)
        if settings.rate_limiting:
            angle = limit_position(
                angle,
                state.elbow_c[0],
                state.delbow_c[0],
                state.ddelbow_c[0],
                self._elbow,
            )
        return [angle, elbow[1]]


def limit_vector(
    velocity: Sequence[float],
    last_velocity: Sequence[float],
    last_acceleration: Sequence[float],
    limits: MotionLimits,
) -> list[float]:
    """Return the velocity nearest to a command that all limits allow, shape (3,).

    Args:
        velocity: The new command [m/s or rad/s], shape (3,).
        last_velocity: The last command, shape (3,).
        last_acceleration: Its acceleration, shape (3,).
        limits: Of the norms.

    Source:
        libfranka@0.9.2 src/rate_limiting.cpp, limitRate of a vector.
    """
    jerk = [
        ((v - v0) / PERIOD - a0) / PERIOD
        for v, v0, a0 in zip(velocity, last_velocity, last_acceleration, strict=True)
    ]
    size = _norm(jerk)
    scale = min(size, limits.jerk) / size if size > _TINY else 0.0
    acceleration = [
        a0 + scale * j * PERIOD for a0, j in zip(last_acceleration, jerk, strict=True)
    ]
    size = _norm(acceleration)
    if size <= _TINY:
        return list(last_velocity)
    direction = [a / size for a in acceleration]
    along = sum(u * v for u, v in zip(direction, last_velocity, strict=True))
    square = sum(v * v for v in last_velocity)
    room = along * along - square + limits.velocity**2
    distance = -along + sqrt(max(0.0, room))
    safe = min(limits.jerk / limits.acceleration * distance, limits.acceleration)
    step = min(size, max(0.0, safe)) * PERIOD
    return [v + u * step for v, u in zip(last_velocity, direction, strict=True)]


def _norm(vector: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in vector))
