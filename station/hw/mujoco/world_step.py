"""One time step of a simulated world: MuJoCo's own step, and the actions around it."""

from collections.abc import Callable
from math import hypot

import cython

from station.memory.doubles import Doubles
from station.memory.vectors import are_within

if not cython.compiled:

    def call_with_two(function: int, first: int, second: int) -> None:
        """Stand in for the compiled call by address; never called in Python."""


class Preparation:
    """Action before every step of a world."""

    def prepare_step(self) -> None:
        """Prepare the coming step."""
        raise NotImplementedError


class SpeedCheck:
    """Compares velocities with their limits.

    Args:
        velocities: The velocities [rad/s or m/s], shape (n,).
        shares: Inverse of the limit of each velocity, >= 0, shape (n,); see
            `take_limits`.
    """

    def __init__(self, velocities: Doubles, shares: Doubles) -> None:
        self.velocities = velocities
        self.shares = shares
        self.size = len(velocities)
        self.slowest = 0.0
        self.take_limits()

    def take_limits(self) -> None:
        """Take over limits that have changed."""
        largest = max(self.shares, default=0.0)
        self.slowest = 1.0 / largest if largest > 0.0 else 0.0

    def holds(self) -> bool:
        """Return whether every velocity is known to be a number within its limit."""
        # In Python, the norm of all velocities takes a third of the time of the check,
        # and if it is below the smallest limit, every velocity is below its own.
        if not cython.compiled and hypot(*self.velocities) < self.slowest:
            return True
        return are_within(self.velocities, self.shares, self.size)


class WorldStep:
    """Makes the steps of a simulated world.

    Args:
        step: Advances the simulation by a time step.
        addresses: Addresses in memory of the C function that does the same, and of its
            two arguments; zeros if they are not known.
        speeds: Checks that the velocities after a step are within their limits.
        brake: Called if a velocity may exceed its limit, and once more after brakes
            have acted.
        count_pushes: Called before a step while a push acts, to count the push down.

    Attributes:
        count: Number of steps since the world exists.
        preparations: Actions before each step, in order.
        stands_still: Whether steps are only counted, because the simulation diverged.
        is_pushed: Whether a push acts.
        is_braked: Whether a brake acted in the last step.
    """

    def __init__(
        self,
        step: Callable[[], None],
        addresses: tuple[int, int, int],
        speeds: SpeedCheck,
        brake: Callable[[], None],
        count_pushes: Callable[[], None],
    ) -> None:
        self.step = step
        self.function, self.model, self.data = addresses
        self.speeds = speeds
        self.brake = brake
        self.count_pushes = count_pushes
        self.count = 0
        self.preparations: list[Preparation] = []
        self.stands_still = False
        self.is_pushed = False
        self.is_braked = False

    def make_step(self) -> None:
        """Prepare and make one step, and brake joints that are too fast."""
        self.count += 1
        if self.stands_still:
            return
        for one in self.preparations:
            one.prepare_step()
        if self.is_pushed:
            self.count_pushes()
        if cython.compiled and self.function:
            call_with_two(self.function, self.model, self.data)
        else:
            self.step()
        if self.is_braked or not self.speeds.holds():
            self.brake()
