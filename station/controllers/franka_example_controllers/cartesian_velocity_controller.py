"""Move the end effector on a line by twist commands.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_velocity_example_controller.cpp; differs: the start pose is checked at
every start, not once when the controller is loaded.
"""

from math import cos, floor, pi, sin
from typing import ClassVar

from typing_extensions import override

from station.controllers.franka_arm import ARM_ID, read_arm_id
from station.controllers.franka_example_controllers.start_pose import check_start_pose
from station.core.control.controller import Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.franka import (
    FrankaCartesianVelocityHandle,
    FrankaVelocityCartesianInterface,
)
from station.core.parameters import Parameters

PEAK = 0.05
"""Highest speed [m/s]."""
HALF_PERIOD = 4.0
"""Time after which the direction changes [s]."""
ANGLE = pi / 4.0
"""Angle of the line below the horizontal [rad]."""


class CartesianVelocityExampleController(Controller[FrankaVelocityCartesianInterface]):
    """Moves forward and down, and back again.

    Parameters: `arm_id`.
    """

    hardware_interface: ClassVar[type] = FrankaVelocityCartesianInterface

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), ARM_ID)

    @override
    def init(
        self, interface: FrankaVelocityCartesianInterface, params: Parameters
    ) -> None:
        name = f"{read_arm_id(params)}_robot"
        self._handle: FrankaCartesianVelocityHandle = interface.get_handle(name)
        self._elapsed = 0.0

    @override
    def starting(self, time: float) -> None:
        """Start at rest.

        Raises:
            ControllerStateError: The arm is not near the start pose.
        """
        check_start_pose(self._handle.get_robot_state().q_d)
        self._elapsed = 0.0

    @override
    def update(self, time: float, period: float) -> None:
        self._elapsed += period
        sign = -1.0 if floor(self._elapsed / HALF_PERIOD) % 2 else 1.0
        speed = PEAK / 2.0 * (1.0 - cos(2.0 * pi / HALF_PERIOD * self._elapsed))
        x, z = cos(ANGLE) * sign * speed, -sin(ANGLE) * sign * speed
        self._handle.set_command([x, 0.0, z, 0.0, 0.0, 0.0])
