"""Positions that follow targets within limits of velocity, acceleration and jerk.

The only module of the controllers that imports something besides core and numbers:
ruckig, which works out time-optimal motions in microseconds and without allocating.
"""

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

from station.controllers.smoothed_motion.motion_limits import MotionLimits
from station.core.errors import InvalidCommandError

_NOMINAL_PERIOD = 0.001


class MotionGenerator:
    """The smooth motion of n joints. Control thread only.

    Args:
        limits: Bounds that hold at all times, but for a start that is faster.

    Attributes:
        positions: Desired positions [rad or m], shape (n,), a new list each cycle.
        velocities: Desired velocities [rad/s or m/s], shape (n,), likewise.
    """

    def __init__(self, limits: MotionLimits) -> None:
        size = len(limits.velocity)
        self.positions = [0.0] * size
        self.velocities = [0.0] * size
        self._size = size
        self._held: list[float] = []  # the velocities to move at, if it is these
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
        """Begin anew at a state and come to rest.

        Args:
            positions: Where the joints are [rad or m], shape (n,).
            velocities: How they move [rad/s or m/s], shape (n,).
        """
        self.positions, self.velocities = list(positions), list(velocities)
        self._ruckig.reset()
        self._input.current_position = positions
        self._input.current_velocity = velocities
        self._input.current_acceleration = [0.0] * self._size
        self._input.target_acceleration = [0.0] * self._size
        self.brake()

    def state(self) -> tuple[list[float], list[float], list[float]]:
        """Return positions, velocities and accelerations, shape (n,) each."""
        return self.positions, self.velocities, self.accelerations

    def restore(self, state: tuple[list[float], list[float], list[float]]) -> None:
        """Go back to what `state` returned; give the target anew afterwards."""
        self.positions, self.velocities, accelerations = state
        self._input.current_position = self.positions
        self._input.current_velocity = self.velocities
        self._input.current_acceleration = accelerations

    @property
    def accelerations(self) -> list[float]:
        """Desired accelerations [rad/s^2 or m/s^2], shape (n,), a new list."""
        result: list[float] = self._input.current_acceleration
        return result

    def relocate(self, positions: list[float]) -> None:
        """Call the present positions otherwise; the motion goes on as it is.

        Give the target anew afterwards.

        Args:
            positions: What the positions are now [rad or m], shape (n,).
        """
        self.positions = positions
        self._input.current_position = positions

    def go_to(self, positions: list[float]) -> None:
        """Go to positions and rest there; all joints arrive together.

        Args:
            positions: Where [rad or m], shape (n,).
        """
        self._held = []
        self._input.control_interface = ControlInterface.Position
        self._input.synchronization = Synchronization.Time
        self._input.target_position = positions
        self._input.target_velocity = [0.0] * self._size

    def go_at(self, velocities: list[float]) -> None:
        """Move at velocities, each joint by itself.

        Args:
            velocities: How fast [rad/s or m/s], shape (n,), within the limits.
        """
        if velocities == self._held:
            return
        self._held = list(velocities)
        self._input.control_interface = ControlInterface.Velocity
        self._input.synchronization = Synchronization.No
        self._input.target_velocity = velocities

    def brake(self) -> None:
        """Come to rest as soon as the limits allow."""
        self.go_at([0.0] * self._size)

    def resting_positions(self) -> list[float]:
        """Return where the joints would come to rest if they braked now [rad or m].

        Raises:
            InvalidCommandError: No motion can be worked out.
        """
        braking = self._braking
        braking.current_position = self._input.current_position
        braking.current_velocity = self._input.current_velocity
        braking.current_acceleration = self._input.current_acceleration
        _check(self._ruckig.calculate(braking, self._trajectory))
        positions: list[float] = self._trajectory.at_time(self._trajectory.duration)[0]
        return positions

    def advance(self, period: float) -> None:
        """Move on.

        Args:
            period: Time since the last cycle [s], >= 0; nothing happens when it is 0.

        Raises:
            InvalidCommandError: No motion to the target can be worked out.
            RuckigError: The same, found otherwise.
        """
        if period == 0.0:
            return
        if period != self._ruckig.delta_time:
            self._ruckig.delta_time = period
        try:
            result = self._ruckig.update(self._input, self._output)
        except RuckigError:
            # Now and then it finds no motion in which all joints arrive together.
            self._input.synchronization = Synchronization.No
            result = self._ruckig.update(self._input, self._output)
        _check(result)
        self._output.pass_to_input(self._input)
        self.positions = self._output.new_position
        self.velocities = self._output.new_velocity


def _check(result: Result) -> None:
    if result not in {Result.Working, Result.Finished}:
        raise InvalidCommandError(
            f"No motion to the target can be worked out: {result}.",
            remedy="Send finite targets within the limits; start the controller again.",
        )
