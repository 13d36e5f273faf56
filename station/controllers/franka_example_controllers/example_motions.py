"""Motions of an arm by each kind of command, from the same start pose.

Source: franka_ros@c11f000 franka_example_controllers, src/*_example_controller.cpp, one
for each class; differs: the start pose is checked at every start, not once when the
controller is loaded.
"""

from collections.abc import Sequence
from math import cos, floor, pi, sin
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    read_arm_id,
    read_arm_joints,
)
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.errors import ControllerStateError
from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaStateHandle,
    FrankaVelocityCartesianInterface,
)
from station.core.hardware.interfaces import (
    JointGroup,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.parameters import Parameters

START_POSE = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""Joint positions from which the motion examples start [rad], shape (7,)."""
TOLERANCE = 0.1
"""Largest distance of a joint from the start pose [rad]."""

_REMEDY = (
    "Bring the arm to its start pose first: station goto TRAJECTORY_CONTROLLER "
    + " ".join(f"{q:.6g}" for q in START_POSE)
)


def check_start_pose(q_d: Sequence[float]) -> None:
    """Refuse an arm that is not near the start pose.

    Args:
        q_d: Desired joint positions [rad], shape (7,).

    Raises:
        ControllerStateError: A joint is too far from the start pose.
    """
    for number, (q, start) in enumerate(zip(q_d, START_POSE, strict=True), 1):
        if not abs(q - start) <= TOLERANCE:
            raise ControllerStateError(
                f"Joint {number} is at {q:.4f} rad; this example starts at "
                f"{start:.4f} rad, at most {TOLERANCE} rad away. {_REMEDY}.",
                remedy=_REMEDY,
                details={"joint": number, "position": q},
            )


def back_and_forth(elapsed: float, *, peak: float, half_period: float) -> float:
    """Return the velocity of a smooth motion back and forth, from rest to rest.

    Args:
        elapsed: Time since the start [s], >= 0.
        peak: Highest velocity, in any unit.
        half_period: Time after which the direction changes [s], > 0.
    """
    sign = -1.0 if floor(elapsed / half_period) % 2 else 1.0
    turn = 2.0 * pi / half_period * elapsed
    return sign * (peak / 2.0 * (1.0 - cos(turn)))


InterfaceT = TypeVar("InterfaceT")


class _Example(Controller[InterfaceT]):
    """Moves from the start pose, as a function of the time since the start."""

    def begin(self) -> Sequence[float]:
        """Return the joint positions from which the motion begins [rad], shape (7,)."""
        raise NotImplementedError

    def move(self, elapsed: float) -> None:
        """Command the motion.

        Args:
            elapsed: Time since the start [s].
        """
        raise NotImplementedError

    @override
    def starting(self, time: float) -> None:
        """Start where the arm is.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        check_start_pose(self.begin())
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        self.move(self._elapsed)


JointsT = TypeVar("JointsT", PositionJointInterface, VelocityJointInterface)


class _JointExample(_Example[JointsT]):
    own_parameters: ClassVar[tuple[DeclaredParameter, ...]] = (JOINT_NAMES,)

    @override
    def init(self, interface: JointsT, params: Parameters) -> None:
        self.joint_names = read_arm_joints(params)
        self._joints = JointGroup([interface.get_handle(n) for n in self.joint_names])

    @override
    def begin(self) -> Sequence[float]:
        self._start = self._joints.get_positions()
        return self._start


JOINT_AMPLITUDE = 0.2 * pi / 16.0
"""Half of the range in which each joint moves [rad]."""
_MIRRORED = 4


class JointPositionExampleController(_JointExample[PositionJointInterface]):
    """Swings all joints with a period of 10 s, the fifth in the opposite direction.

    Parameters: `joint_names`, 7 names.
    """

    @override
    def move(self, elapsed: float) -> None:
        offset = JOINT_AMPLITUDE * (1.0 - cos(pi / 5.0 * elapsed))
        self._joints.set_commands([
            q - offset if joint == _MIRRORED else q + offset
            for joint, q in enumerate(self._start)
        ])


JOINT_PEAK = 0.1
"""Highest velocity [rad/s]."""
JOINT_HALF_PERIOD = 8.0
"""Time after which the direction changes [s]."""


class JointVelocityExampleController(_JointExample[VelocityJointInterface]):
    """Moves all joints back and forth at the same velocity.

    Parameters: `joint_names`, 7 names. `arm_id` is accepted and has no effect.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = ("arm_id",)

    @override
    def move(self, elapsed: float) -> None:
        omega = back_and_forth(elapsed, peak=JOINT_PEAK, half_period=JOINT_HALF_PERIOD)
        self._joints.set_commands([omega] * len(self.joint_names))


HandT = TypeVar("HandT", FrankaPoseCartesianInterface, FrankaVelocityCartesianInterface)


class _HandExample(_Example[HandT]):
    own_parameters = (ARM_ID,)
    _handle: FrankaStateHandle

    @override
    def init(self, interface: HandT, params: Parameters) -> None:
        self._handle = interface.get_handle(f"{read_arm_id(params)}_robot")

    @override
    def begin(self) -> Sequence[float]:
        state = self._handle.get_robot_state()
        self._pose, self._elbow = list(state.O_T_EE_d), list(state.elbow_d)
        return state.q_d


RADIUS = 0.15
"""Radius of the arc [m]."""


class CartesianPoseExampleController(_HandExample[FrankaPoseCartesianInterface]):
    """Moves along a quarter of a vertical circle and back, in 10 s.

    Parameters: `arm_id`.
    """

    _handle: FrankaCartesianPoseHandle

    @override
    def starting(self, time: float) -> None:
        """Start at the desired pose of the end effector.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        super().starting(time)
        self._handle.set_command(self._pose)

    @override
    def move(self, elapsed: float) -> None:
        angle = pi / 4.0 * (1.0 - cos(pi / 5.0 * elapsed))
        pose = list(self._pose)
        pose[12] -= RADIUS * sin(angle)
        pose[14] -= RADIUS * (cos(angle) - 1.0)
        self._handle.set_command(pose)


TWIST_PEAK = 0.05
"""Highest speed [m/s]."""
TWIST_HALF_PERIOD = 4.0
"""Time after which the direction changes [s]."""
ANGLE = pi / 4.0
"""Angle of the line below the horizontal [rad]."""


class CartesianVelocityExampleController(
    _HandExample[FrankaVelocityCartesianInterface]
):
    """Moves forward and down, and back again.

    Parameters: `arm_id`.
    """

    _handle: FrankaCartesianVelocityHandle

    @override
    def move(self, elapsed: float) -> None:
        speed = back_and_forth(elapsed, peak=TWIST_PEAK, half_period=TWIST_HALF_PERIOD)
        x, z = cos(ANGLE) * speed, -sin(ANGLE) * speed
        self._handle.set_command([x, 0.0, z, 0.0, 0.0, 0.0])


ELBOW_AMPLITUDE = pi / 10.0
"""Half of the range in which joint 3 moves [rad]."""


class ElbowExampleController(_HandExample[FrankaPoseCartesianInterface]):
    """Swings the elbow to one side and back, in 10 s.

    Parameters: `arm_id`.
    """

    _handle: FrankaCartesianPoseHandle

    @override
    def starting(self, time: float) -> None:
        """Start at the desired pose and elbow.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        super().starting(time)
        self._handle.set_command(self._pose, self._elbow)

    @override
    def move(self, elapsed: float) -> None:
        offset = ELBOW_AMPLITUDE * (1.0 - cos(pi / 5.0 * elapsed))
        self._handle.set_command(self._pose, [self._elbow[0] + offset, self._elbow[1]])
