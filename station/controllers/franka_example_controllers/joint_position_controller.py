"""Swing every joint by position commands.

Source: franka_ros@c11f000 franka_example_controllers,
src/joint_position_example_controller.cpp; differs: the start pose is checked at every
start, not once when the controller is loaded.
"""

from math import cos, pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.franka_arm import JOINT_NAMES, read_arm_joints
from station.controllers.franka_example_controllers.start_pose import check_start_pose
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.hardware.interfaces import JointGroup, PositionJointInterface
from station.core.parameters import Parameters

AMPLITUDE = 0.2 * pi / 16.0
"""Half of the range in which each joint moves [rad]."""
_MIRRORED = 4


class JointPositionExampleController(Controller[PositionJointInterface]):
    """Swings all joints with a period of 10 s, the fifth in the opposite direction.

    Parameters: `joint_names`, 7 names.
    """

    hardware_interface: ClassVar[type] = PositionJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._joints = JointGroup([])
        self._start: list[float] = []
        self._elapsed = 0.0

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), JOINT_NAMES)

    @override
    def init(self, interface: PositionJointInterface, params: Parameters) -> None:
        names = read_arm_joints(params)
        self._joints = JointGroup([interface.get_handle(name) for name in names])
        self.joint_names = names

    @override
    def starting(self, time: float) -> None:
        """Start at the measured joint positions.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        self._start = self._joints.get_positions()
        check_start_pose(self._start)
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        offset = AMPLITUDE * (1.0 - cos(pi / 5.0 * self._elapsed))
        self._joints.set_commands([
            q - offset if joint == _MIRRORED else q + offset
            for joint, q in enumerate(self._start)
        ])
