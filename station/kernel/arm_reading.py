"""Bring the state of an arm up to date, once per cycle."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from station.kernel.arm_step import ArmStep
from station.kernel.finite_check import FiniteCheck
from station.kernel.flags import AlertFlag, ContactFlag, MotionFlags
from station.kernel.imperfections import Imperfections
from station.kernel.stages import Stage
from station.kernel.world_step import WorldStep

if TYPE_CHECKING:
    from station.kernel.finger_motor import FingerSensor


class TimedState(Protocol):
    """A state with its time [s]."""

    time: float


class Cycles:
    """The cycles of an arm. Reading a state ends a cycle, and begins the next one."""

    def read(self) -> None:
        """Bring the state of the next cycle."""
        raise NotImplementedError


class CalledCycles(Cycles):
    """The cycles of an arm that is read by a Python function.

    Args:
        function: Brings the state of the next cycle.
    """

    def __init__(self, function: Callable[[], object]) -> None:
        self.function = function

    def read(self) -> None:
        """Call the function."""
        self.function()


class SimulatedCycles(Cycles):
    """The cycles of a simulated arm, as far as they are usual ones.

    Args:
        step: The arm's arithmetic around a step of its world.
        world: The world's steps.
        state: The arm's state; its time is written.
        period: Duration of a cycle [s], > 0.
        contact: Estimates contacts; looked at while it is not quiet.
        supervisor: Looks at readings; looked at while it is alert.
        read_closely: Reads the joints at a time [s] while a load or a fault acts;
            returns what `ArmStep.after` returns.
        imperfections: Disturb the readings; None for an ideal arm.
        expect_load: Tells the imperfections of a configured load, before they act.
        attend: Attends to what the imperfections have found.
        supervise: Looks closer, given what `ArmStep.after` has found.

    Attributes:
        cycle: Number of the last cycle.
        seen: Number of the step after which the joints were read last.
    """

    def __init__(
        self,
        step: ArmStep,
        world: WorldStep,
        *,
        state: TimedState,
        period: float,
        contact: ContactFlag,
        supervisor: AlertFlag,
        read_closely: Callable[[float], int],
        imperfections: Imperfections | None,
        expect_load: Callable[[], None],
        attend: Callable[[int], None],
        supervise: Callable[[int], None],
    ) -> None:
        self.step = step
        self.world = world
        self.state = state
        self.period = period
        self.contact = contact
        self.supervisor = supervisor
        self.read_closely = read_closely
        self.imperfections = imperfections
        self.expect_load = expect_load
        self.attend = attend
        self.supervise = supervise
        self.cycle = world.count
        self.seen = world.count

    def read(self) -> None:
        """Let the world make its step if no other arm has, and read the joints."""
        world, step = self.world, self.step
        self.cycle += 1
        while world.count < self.cycle:
            world.make()
        steps = world.count
        if self.seen >= steps:
            return
        self.seen = steps
        time = steps * self.period
        if step.has_load or step.has_faults:
            found = self.read_closely(time)
        else:
            found = step.after(time)
            self.state.time = time
        if self.imperfections is not None:
            if step.has_load:
                self.expect_load()
            unusual = self.imperfections.sense()
            if unusual:
                self.attend(unusual)
        if (
            found
            or world.is_pushed
            or world.stands_still
            or step.has_load
            or not self.contact.is_quiet
            or self.supervisor.is_alert
        ):
            self.supervise(found)


class ArmReading(Stage):
    """Reads an arm once per elapsed cycle time.

    Args:
        cycles: The arm's cycles.
        readings: Looks for a reading that is not finite.
        motion: The motion that may wait for the arm.
        cycle_time: Duration of the arm's cycle [s], > 0.
        catch_up: Reads the arm as often as the time that is due demands, and takes that
            time from `time_due`; returns how often. For any number but one.
        end_motion: Called when a reading is not finite.

    Attributes:
        time_due: Time for which the arm has not been read yet [s].
        nominal: Cycles of the arm per cycle of the loop.
        bad: Number of a reading that is not finite; -1 when all are.
        fingers: Reads the fingers; None without a simulated hand.
    """

    def __init__(
        self,
        cycles: Cycles,
        readings: FiniteCheck,
        motion: MotionFlags,
        *,
        cycle_time: float,
        catch_up: Callable[[], int],
        end_motion: Callable[[], None],
    ) -> None:
        self.cycles = cycles
        self.readings = readings
        self.motion = motion
        self.cycle_time = cycle_time
        self.catch_up = catch_up
        self.end_motion = end_motion
        self.fingers: FingerSensor | None = None
        self.time_due = 0.0
        self.nominal = 1
        self.bad = -1

    def run(self, time: float, period: float) -> None:
        """Read the arm; see `Stage.run`."""
        self.time_due += period
        share, count = self.time_due / self.cycle_time, 1
        if self.nominal == 1 and 0.5 < share < 1.5:
            self.time_due -= self.cycle_time
            self.cycles.read()
        else:
            count = self.catch_up()
        if self.motion.is_waiting:
            self.motion.advance(count)
        self.bad = self.readings.first_bad()
        if self.bad >= 0:
            # A controller that used such a reading would command garbage.
            self.end_motion()
        if self.fingers is not None:
            self.fingers.read()
