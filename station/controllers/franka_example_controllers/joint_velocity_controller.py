"""Swing every joint by velocity commands.

Source: franka_ros@c11f000 franka_example_controllers,
src/joint_velocity_example_controller.cpp; differs: the start pose is checked at every
start, not once when the controller is loaded.
"""

from math import cos, floor, pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.franka_arm import JOINT_NAMES, read_arm_joints
from station.controllers.franka_example_controllers.start_pose import check_start_pose
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.hardware.interfaces import JointGroup, VelocityJointInterface
from station.core.parameters import Parameters

PEAK = 0.1
"""Highest velocity [rad/s]."""
HALF_PERIOD = 8.0
"""Time after which the direction changes [s]."""


class JointVelocityExampleController(Controller[VelocityJointInterface]):
    """Moves all joints back and forth at the same velocity.

    Parameters: `joint_names`, 7 names. `arm_id` is accepted and has no effect.
    """

    hardware_interface: ClassVar[type] = VelocityJointInterface
    accepted_parameters: ClassVar[tuple[str, ...]] = ("arm_id",)

    def __init__(self) -> None:
        super().__init__()
        self._joints = JointGroup([])
        self._elapsed = 0.0

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), JOINT_NAMES)

    @override
    def init(self, interface: VelocityJointInterface, params: Parameters) -> None:
        names = read_arm_joints(params)
        self._joints = JointGroup([interface.get_handle(name) for name in names])
        self.joint_names = names

    @override
    def starting(self, time: float) -> None:
        """Start at rest.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        check_start_pose(self._joints.get_positions())
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        sign = -1.0 if floor(self._elapsed / HALF_PERIOD) % 2 else 1.0
        omega = PEAK / 2.0 * (1.0 - cos(2.0 * pi / HALF_PERIOD * self._elapsed))
        self._joints.set_commands([sign * omega] * len(self.joint_names))
