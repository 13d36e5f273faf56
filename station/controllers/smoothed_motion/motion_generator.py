"""Generate positions that follow targets within limits of velocity and its rates.

Ruckig computes time-optimal motions within limits of velocity, acceleration and jerk in
microseconds and without allocating memory. No other module of the controllers imports
anything but core and NumPy.
"""

from typing import TYPE_CHECKING, NoReturn

from ruckig import (
    ControlInterface,
    InputParameter,
    OutputParameter,
    Result,
    Ruckig,
    RuckigError,
    Synchronization,
    Trajectory,
)

from station.core.errors import InvalidCommandError

if TYPE_CHECKING:
    from station.controllers.smoothed_motion.axis_limits import AxisLimits

_NOMINAL_PERIOD = 0.001
# Velocities and accelerations below this are rounding after a motion has ended.
_AT_REST = 1e-12
# Ruckig's answers without an error; members of the enumeration are compared fastest by
# their identity.
_WORKING, _FINISHED = Result.Working, Result.Finished


class MotionGenerator:
    """The smooth motion of n axes. Control thread only.

    Args:
        limits: Limits of the motion. They are exceeded only after a start with a higher
            velocity, until the motion has slowed down.

    Attributes:
        positions: Desired positions [rad or m], shape (n,), a new list each cycle.
        velocities: Desired velocities [rad/s or m/s], shape (n,), a new list each
            cycle.
        accelerations: Desired accelerations [rad/s^2 or m/s^2], shape (n,), a new list
            each cycle.
        is_still: Whether the axes rest, and nothing but rest is wanted: `advance` does
            nothing.
    """

    def __init__(self, limits: "AxisLimits") -> None:
        size = len(limits.velocity)
        self.positions = [0.0] * size
        self.velocities = [0.0] * size
        self.accelerations = [0.0] * size
        self.is_still = False
        self._size = size
        # The target velocities; empty while the target is a position.
        self._held: list[float] = []
        # The target positions that Ruckig was told last.
        self._wanted: list[float] = []
        # Whether Ruckig was told that the target is a position.
        self._goes_to_positions = False
        self._period = _NOMINAL_PERIOD
        self._ruckig = Ruckig(size, _NOMINAL_PERIOD)
        self._input = InputParameter(size)
        self._output = OutputParameter(size)
        self._braking = InputParameter(size)
        self._trajectory = Trajectory(size)
        for each in (self._input, self._braking):
            each.max_velocity = list(limits.velocity)
            each.max_acceleration = list(limits.acceleration)
            each.max_jerk = list(limits.jerk)
        self._braking.control_interface = ControlInterface.Velocity
        self._braking.synchronization = Synchronization.No
        self._braking.target_velocity = [0.0] * size
        self._braking.target_acceleration = [0.0] * size

    def start(self, positions: list[float], velocities: list[float]) -> None:
        """Start at a state and come to rest.

        Args:
            positions: Present positions [rad or m], shape (n,).
            velocities: Present velocities [rad/s or m/s], shape (n,).
        """
        self.positions, self.velocities = list(positions), list(velocities)
        self.is_still = False
        self._ruckig.reset()
        self._input.current_position = positions
        self._input.current_velocity = velocities
        self.accelerations = [0.0] * self._size
        self._input.current_acceleration = self.accelerations
        self._input.target_acceleration = [0.0] * self._size
        self.brake()

    def state(self) -> tuple[list[float], list[float], list[float]]:
        """Return positions, velocities and accelerations, shape (n,) each."""
        return self.positions, self.velocities, self.accelerations

    def restore(self, state: tuple[list[float], list[float], list[float]]) -> None:
        """Return to a result of `state`. Set the target again afterwards."""
        self.is_still = False
        self.positions, self.velocities, self.accelerations = state
        self._input.current_position = self.positions
        self._input.current_velocity = self.velocities
        self._input.current_acceleration = self.accelerations

    def relocate(self, positions: list[float]) -> None:
        """Change the coordinates of the present positions without changing the motion.

        Set the target again afterwards.

        Args:
            positions: Present positions in the new coordinates [rad or m], shape (n,);
                the same list if they have not changed.
        """
        if positions is not self.positions:
            self.positions = positions
            self._input.current_position = positions

    def go_to(self, positions: list[float]) -> None:
        """Make positions the target: all axes arrive together and rest there.

        Args:
            positions: Target positions [rad or m], shape (n,); the caller does not
                change the list afterwards.
        """
        self.is_still, self._held = False, []
        if positions is not self._wanted:
            self._wanted = positions
            self._input.target_position = positions
        if not self._goes_to_positions:  # every assignment costs as much as a `put`
            self._goes_to_positions = True
            self._input.control_interface = ControlInterface.Position
            self._input.synchronization = Synchronization.Time
            self._input.target_velocity = [0.0] * self._size

    def go_at(self, velocities: list[float]) -> None:
        """Make velocities the target, which each axis reaches as soon as it can.

        Args:
            velocities: Target velocities within the limits [rad/s or m/s], shape (n,);
                the caller does not change the list afterwards.
        """
        if velocities is self._held or velocities == self._held:
            return
        self.is_still, self._held = False, velocities
        self._goes_to_positions = False
        self._input.control_interface = ControlInterface.Velocity
        self._input.synchronization = Synchronization.No
        self._input.target_velocity = velocities

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        self.go_at([0.0] * self._size)

    def resting_positions(self) -> list[float]:
        """Return the positions at which the axes rest if they brake now [rad or m].

        Raises:
            InvalidCommandError: No motion to rest is possible.
        """
        braking = self._braking
        braking.current_position = self._input.current_position
        braking.current_velocity = self._input.current_velocity
        braking.current_acceleration = self._input.current_acceleration
        result = self._ruckig.calculate(braking, self._trajectory)
        if int(result) < 0:
            _refuse(result)
        positions: list[float] = self._trajectory.at_time(self._trajectory.duration)[0]
        return positions

    def advance(self, period: float) -> None:
        """Advance the motion by one period.

        Args:
            period: Time since the last cycle [s], >= 0; nothing happens when it is 0.

        Raises:
            InvalidCommandError: There is no motion to the target.
            RuckigError: There is no motion to the target.
        """
        if period == 0.0 or self.is_still:
            return
        if period != self._period:
            self._period = self._ruckig.delta_time = period
        try:
            result = self._ruckig.update(self._input, self._output)
        except RuckigError:
            # Rarely Ruckig finds no motion in which all axes arrive together, but finds
            # a motion in which each axis arrives by itself.
            self._input.synchronization = Synchronization.No
            self._goes_to_positions = False
            result = self._ruckig.update(self._input, self._output)
        # All errors are negative.
        if result is not _WORKING and result is not _FINISHED and int(result) < 0:
            _refuse(result)
        output = self._output
        output.pass_to_input(self._input)
        self.positions = output.new_position
        self.velocities = output.new_velocity
        self.accelerations = output.new_acceleration
        if self._held and not any(self._held) and self._has_ended():
            self.velocities = self.accelerations = [0.0] * self._size
            self._input.current_velocity = self.velocities
            self._input.current_acceleration = self.accelerations
            self.is_still = True

    def _has_ended(self) -> bool:
        """Return whether no axis moves or accelerates, but for rounding."""
        if max(map(abs, self.velocities)) > _AT_REST:
            return False
        return max(map(abs, self.accelerations)) <= _AT_REST


def _refuse(result: Result) -> NoReturn:
    raise InvalidCommandError(
        f"There is no motion to the target: {result}.",
        remedy="Send finite targets within the limits and restart the controller.",
    )
