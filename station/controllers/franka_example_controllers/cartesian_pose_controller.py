"""Move the end effector on an arc by pose commands.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_pose_example_controller.cpp; differs: the start pose is checked at every
start, not once when the controller is loaded.
"""

from math import cos, pi, sin
from typing import ClassVar

from typing_extensions import override

from station.controllers.franka_arm import ARM_ID, read_arm_id
from station.controllers.franka_example_controllers.start_pose import check_start_pose
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.franka import FrankaCartesianPoseHandle, FrankaPoseCartesianInterface
from station.core.parameters import Parameters

RADIUS = 0.15
"""Radius of the arc [m]."""


class CartesianPoseExampleController(Controller[FrankaPoseCartesianInterface]):
    """Moves along a quarter of a vertical circle and back, in 10 s.

    Parameters: `arm_id`.
    """

    hardware_interface: ClassVar[type] = FrankaPoseCartesianInterface

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), ARM_ID)

    @override
    def init(self, interface: FrankaPoseCartesianInterface, params: Parameters) -> None:
        name = f"{read_arm_id(params)}_robot"
        self._handle: FrankaCartesianPoseHandle = interface.get_handle(name)
        self._start: list[float] = []
        self._elapsed = 0.0

    @override
    def starting(self, time: float) -> None:
        """Start at the desired pose of the end effector.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        state = self._handle.get_robot_state()
        check_start_pose(state.q_d)
        self._start = list(state.O_T_EE_d)
        self._handle.set_command(self._start)
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        angle = pi / 4.0 * (1.0 - cos(pi / 5.0 * self._elapsed))
        pose = list(self._start)
        pose[12] -= RADIUS * sin(angle)
        pose[14] -= RADIUS * (cos(angle) - 1.0)
        self._handle.set_command(pose)
