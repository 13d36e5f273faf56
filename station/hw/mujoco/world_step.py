"""One time step of a simulated world: MuJoCo's own step, and what is done around it."""

from collections.abc import Callable

import cython

from station.hw.mujoco.speed_check import SpeedCheck

if not cython.compiled:

    def call_with_two(function: int, first: int, second: int) -> None:
        """Call a C function by its address; Python cannot, and does not."""


class Preparation:
    """Something that is done before every step of a world."""

    def prepare_step(self) -> None:
        """Prepare the coming step."""
        raise NotImplementedError


class CalledPreparation(Preparation):
    """A preparation that is a Python function.

    Args:
        function: Prepares the coming step.
    """

    def __init__(self, function: Callable[[], object]) -> None:
        self.function = function

    def prepare_step(self) -> None:
        """Call the function."""
        self.function()


class WorldStep:
    """Makes the steps of a simulated world.

    Args:
        step: Advances the simulation by a time step.
        addresses: Addresses in memory of the C function that does the same, and of its
            two arguments; zeros if they are not known.
        speeds: Whether the velocities after a step are usual ones.
        look: Looks at velocities that are not, and brakes.
        count_pushes: Counts the steps that pushes last.

    Attributes:
        count: Number of steps since the world exists.
        preparations: What is done before each step, in order.
        stands_still: Whether steps are only counted, because the simulation diverged.
        is_pushed: Whether something is pushed.
        is_braked: Whether a brake acted in the last step.
    """

    def __init__(
        self,
        step: Callable[[], None],
        addresses: tuple[int, int, int],
        speeds: SpeedCheck,
        look: Callable[[], None],
        count_pushes: Callable[[], None],
    ) -> None:
        self.step = step
        self.function, self.model, self.data = addresses
        self.speeds = speeds
        self.look = look
        self.count_pushes = count_pushes
        self.count = 0
        self.preparations: list[Preparation] = []
        self.stands_still = False
        self.is_pushed = False
        self.is_braked = False

    def make_step(self) -> None:
        """Make one step."""
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
            self.look()
