"""The base of the controllers whose motion is smoothed."""

from dataclasses import replace
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import (
    JointQuantity,
    JointSetPointController,
)
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
)
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.controllers.smoothed_motion.motion_limits import (
    MotionLimits,
    read_motion_limits,
)
from station.core.control.controller import ControllerSample
from station.core.description.robot_description import (
    RobotDescription,
    require_robot_description,
)
from station.core.parameters import Parameters

LONGEST_TIMEOUT = 1.0
"""Longest validity of a set-point [s]: whoever commands has to go on saying so."""


class SmoothedMotionController(JointSetPointController[CommandInterfaceT]):
    """Moves joints within limits of velocity, acceleration and jerk.

    When it starts, and when set-points stay out, the joints come to rest within the
    limits and hold. Subclasses say what a set-point means and command the hardware.

    Parameters: `joints`; `max_velocity`, `max_acceleration`, `max_jerk`, see
    `read_motion_limits`; `command_timeout` [s], 0.2, at most 1.0;
    `command_timeout_action`, `hold` or `stop`. `robot_description` in this or an outer
    namespace gives types and limits of the joints.
    """

    default_timeout: ClassVar[float] = 0.2
    longest_timeout: ClassVar[float] = LONGEST_TIMEOUT

    def __init__(self) -> None:
        super().__init__()
        self.limits = MotionLimits((), (), ())
        self.generator = MotionGenerator(self.limits)

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self.limits = read_motion_limits(params, self.joints)
        self.generator = MotionGenerator(self.limits)
        if self.quantity is JointQuantity.VELOCITY and self.set_points is not None:
            self.set_points.elements = [
                replace(element, minimum=-bound, maximum=bound)
                for element, bound in zip(
                    self.set_points.elements, self.limits.velocity, strict=True
                )
            ]

    @override
    def find_description(self, params: Parameters) -> RobotDescription | None:
        """Return the robot description, without which this controller is not safe.

        Raises:
            RobotDescriptionError: There is none, or it cannot be used.
        """
        return require_robot_description(params)

    def steer(self, set_point: list[float], period: float) -> None:
        """Tell the generator where to go in this cycle.

        Args:
            set_point: The set-point in force, shape (n,).
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    def heading(self, set_point: list[float]) -> list[float]:
        """Return in which direction each joint shall go, shape (n,).

        Args:
            set_point: The set-point in force, shape (n,).
        """
        raise NotImplementedError

    def wait(self) -> None:
        """Let the smoothed motion come to rest in this cycle instead of `steer`."""
        self.generator.brake()

    def reset_command(self) -> None:
        """Forget what happened before; called when the controller starts."""

    def command(self, actual: list[float], period: float) -> list[float]:
        """Command the joints towards the generator's state; return the commands.

        Args:
            actual: Measured positions [rad or m], shape (n,).
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    @override
    def starting(self, time: float) -> None:
        self.generator.start(self.group.get_positions(), self.group.get_velocities())
        self.reset_command()
        super().starting(time)

    @override
    def update(self, time: float, period: float) -> None:
        """Report the smoothed positions as the desired ones."""
        self.steer(self.newest_set_point(), period)
        self.generator.advance(period)
        actual = self.group.get_positions()
        output = self.command(actual, period)
        desired = self.generator.positions
        errors = [d - a for d, a in zip(desired, actual, strict=True)]
        self.sample = ControllerSample(time, desired, actual, errors, output)
