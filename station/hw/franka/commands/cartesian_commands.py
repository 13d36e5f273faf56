"""The arm's Cartesian interfaces: command buffers, handles on them, what is sent.

Source: libfranka@0.9.2 src/control_loop.cpp, convertMotion; src/lowpass_filter.cpp,
cartesianLowpassFilter; src/rate_limiting.cpp, limitRate.
"""

from collections.abc import Sequence
from dataclasses import replace

from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.franka.command_rates import filtered
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.robot_arm import RobotArm, receivers_of
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.pose_bridge import PoseBridge
from station.hw.franka.commands.pose_rates import PoseRates
from station.hw.franka.commands.pose_sending import PoseSend
from station.hw.franka.commands.rate_limiter import (
    PERIOD,
    RateLimits,
    limit_position,
    low_pass_gain,
    with_margins,
)
from station.memory.doubles import Block, put, viewed
from station.memory.finite_check import FiniteCheck

# libfranka's margin for the rotation of a pose.
_ROTATION_SHARE = 0.99


class CartesianCommands:
    """Cartesian command handles of one arm, and its filter and limits for them.

    Args:
        arm: The arm.
        arm_id: Prefix of its names.
        limits: Its limits.

    Attributes:
        has_pose: Whether pose commands are taken.
        has_twist: Whether twist commands are taken.
        pose_send: Sends a pose in a usual cycle; None if only `send` does.
    """

    def __init__(self, arm: RobotArm, arm_id: str, limits: ArmLimits) -> None:
        self._arm = arm
        block = Block({"pose": 16, "twist": 6, "pose_elbow": 2, "twist_elbow": 2})
        self._pose, self._pose_elbow = block["pose"], block["pose_elbow"]
        self._twist, self._twist_elbow = block["twist"], block["twist_elbow"]
        put(self._pose, IDENTITY)
        self._bridge = PoseBridge()
        self.has_pose = self.has_twist = False
        losses = limits.tolerated_losses
        state = arm.state
        self._rates = PoseRates(
            state.doubles("O_T_EE_c"),
            state.doubles("O_dP_EE_c"),
            state.doubles("O_ddP_EE_c"),
            translation=with_margins(limits.translation, losses).bounds(),
            rotation=with_margins(limits.rotation, losses).bounds(),
            pose_share=_ROTATION_SHARE,
            period=PERIOD,
        )
        elbow = with_margins(
            replace(limits.elbow, velocity=limits.limiter_elbow_velocity), losses
        )
        self._elbow = RateLimits(elbow.velocity, elbow.acceleration, elbow.jerk, 1.0)
        poses = receivers_of(arm).poses
        self.pose_send: PoseSend | None = None
        if poses is not None:
            self.pose_send = PoseSend(
                self._bridge, self._pose, self._pose_elbow, self._rates, poses
            )
        self._filters_first_pose = limits.filters_first_pose
        self._is_first = False
        self._settings: CommandSettings | None = None
        name, refresh = f"{arm_id}_robot", arm.refresh_state
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
            put(self._pose, self._arm.state.O_T_EE_d)
        for rest in (self._twist, self._pose_elbow, self._twist_elbow):
            put(rest, [0.0] * len(rest))
        self._bridge.begin(self._pose, self._arm.state.elbow_d)
        self._is_first = True
        if self.pose_send is not None:
            self.pose_send.is_usual = False

    def checks(self) -> tuple[FiniteCheck, ...]:
        """Return what looks for commands that are not finite, for what is taken."""
        pose = (self._pose, self._pose_elbow) if self.has_pose else ()
        twist = (self._twist, self._twist_elbow) if self.has_twist else ()
        return tuple(map(FiniteCheck, (*pose, *twist)))

    def send(self, settings: CommandSettings, *, is_new: bool) -> None:
        """Filter, limit and send what is taken.

        Args:
            settings: Cutoff frequency and whether to limit.
            is_new: Whether controllers have updated since the last call.

        Raises:
            InvalidCommandError: The elbow's sign is not +1 or -1.
        """
        arm, rates = self._arm, self._rates
        if settings is not self._settings:
            self._settings = settings
            rates.gain = low_pass_gain(settings.cutoff_frequency)
            rates.is_limiting = settings.rate_limiting
        if self.has_pose:
            passes = self._is_first and not self._filters_first_pose
            self._is_first = False
            bridge = self._bridge
            pose, bent = (
                bridge.pass_on(self._pose, self._pose_elbow)
                if is_new
                else bridge.bridge()
            )
            rates.filter_pose(viewed(pose), passes)
            elbow = self._limited_elbow(bent, passes=passes)
            arm.command_cartesian_pose(rates.sent_pose, elbow)
            if self.pose_send is not None:
                self.pose_send.is_usual = not self.has_twist
        if self.has_twist:
            rates.filter_twist(self._twist)
            elbow = self._limited_elbow(self._twist_elbow, passes=False)
            arm.command_cartesian_velocity(rates.sent_twist, elbow)

    def _limited_elbow(
        self, elbow: Sequence[float], *, passes: bool
    ) -> list[float] | None:
        if elbow[0] == 0.0 and elbow[1] == 0.0:
            return None
        state, rates = self._arm.state, self._rates
        angle, last = elbow[0], state.elbow_c[0]
        if rates.gain < 1.0 and not passes:
            angle = filtered(angle, last, rates.gain)
        if rates.is_limiting:
            angle = limit_position(
                angle, last, state.delbow_c[0], state.ddelbow_c[0], self._elbow
            )
        return [angle, elbow[1]]
