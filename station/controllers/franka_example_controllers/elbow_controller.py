"""Move the elbow while the end effector stays.

Source: franka_ros@c11f000 franka_example_controllers,
src/elbow_example_controller.cpp; differs: the start pose is checked at every start, not
once when the controller is loaded.
"""

from math import cos, pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.franka_arm import ARM_ID, read_arm_id
from station.controllers.franka_example_controllers.start_pose import check_start_pose
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.franka import FrankaCartesianPoseHandle, FrankaPoseCartesianInterface
from station.core.parameters import Parameters

AMPLITUDE = pi / 10.0
"""Half of the range in which joint 3 moves [rad]."""


class ElbowExampleController(Controller[FrankaPoseCartesianInterface]):
    """Swings the elbow to one side and back, in 10 s.

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
        self._pose: list[float] = []
        self._elbow: list[float] = []
        self._elapsed = 0.0

    @override
    def starting(self, time: float) -> None:
        """Start at the desired pose of the arm.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        state = self._handle.get_robot_state()
        check_start_pose(state.q_d)
        self._pose, self._elbow = list(state.O_T_EE_d), list(state.elbow_d)
        self._handle.set_command(self._pose, self._elbow)
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        offset = AMPLITUDE * (1.0 - cos(pi / 5.0 * self._elapsed))
        self._handle.set_command(self._pose, [self._elbow[0] + offset, self._elbow[1]])
