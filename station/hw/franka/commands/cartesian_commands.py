"""The arm's Cartesian interfaces: command buffers and their handles."""

from dataclasses import replace

from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.commands.cartesian_sender import CartesianSender, PoseRates
from station.hw.franka.commands.rate_limiter import PERIOD, with_margins
from station.memory.doubles import Block, put
from station.memory.vectors import FiniteCheck

# libfranka's margin for the rotation of a pose, as a share of the limits.
_ROTATION_SHARE = 0.99


class CartesianCommands:
    """Cartesian command handles of one arm, and the sender of its commands.

    Args:
        arm: The arm.
        arm_id: Name of the arm.
        limits: Limits of the arm.
        memory: The commands of the arm, with the parts `pose`, `twist`, `pose_elbow`
            and `twist_elbow`.

    Attributes:
        has_pose: Whether pose commands are taken.
        has_twist: Whether twist commands are taken.
        sender: Filters, limits and sends the commands.
    """

    def __init__(
        self, arm: RobotArm, arm_id: str, limits: ArmLimits, memory: Block
    ) -> None:
        self._arm = arm
        self._pose, self._pose_elbow = memory["pose"], memory["pose_elbow"]
        self._twist, self._twist_elbow = memory["twist"], memory["twist_elbow"]
        put(self._pose, IDENTITY)
        self.has_pose = self.has_twist = False
        state, losses = arm.state, limits.tolerated_losses
        elbow = replace(limits.elbow, velocity=limits.limiter_elbow_velocity)
        rates = PoseRates(
            state,
            translation=with_margins(limits.translation, losses).bounds(),
            rotation=with_margins(limits.rotation, losses).bounds(),
            elbow=with_margins(elbow, losses).bounds(),
            pose_share=_ROTATION_SHARE,
            period=PERIOD,
        )
        self.sender = CartesianSender(
            arm,
            rates,
            pose=self._pose,
            twist=self._twist,
            pose_elbow=self._pose_elbow,
            twist_elbow=self._twist_elbow,
            filters_first=limits.filters_first_pose,
        )
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

    def begin_commands(self, mode: ControlMode) -> None:
        """Take commands of the kinds in `mode` from now on, starting at rest."""
        self.has_pose = bool(mode & ControlMode.CARTESIAN_POSE)
        self.has_twist = bool(mode & ControlMode.CARTESIAN_VELOCITY)
        # Rest is the pose that the arm desires now; another pose would be a jump.
        if self.has_pose:
            self._arm.refresh_state()
            put(self._pose, self._arm.state.O_T_EE_d)
        # Zeros mean no motion, and an elbow that the arm chooses.
        for rest in (self._twist, self._pose_elbow, self._twist_elbow):
            put(rest, [0.0] * len(rest))

    def checks(self) -> tuple[FiniteCheck, ...]:
        """Return the checks of the taken commands for numbers that are not finite."""
        pose = (self._pose, self._pose_elbow) if self.has_pose else ()
        twist = (self._twist, self._twist_elbow) if self.has_twist else ()
        return tuple(map(FiniteCheck, (*pose, *twist)))
