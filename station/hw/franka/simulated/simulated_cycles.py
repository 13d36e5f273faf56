"""Bring the state of a simulated arm up to date, once per cycle."""

from collections.abc import Callable
from typing import Protocol

from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.imperfections import Imperfections
from station.hw.mujoco.world_step import WorldStep


class ContactFlag:
    """Tells about the contacts of an arm.

    Attributes:
        is_quiet: Whether nothing touches the arm.
    """

    def __init__(self) -> None:
        self.is_quiet = True


class AlertFlag:
    """Tells about the readings of an arm.

    Attributes:
        is_alert: Whether a reading of the last cycle was out of its range.
    """

    def __init__(self) -> None:
        self.is_alert = False


class TimedState(Protocol):
    """A state with its time [s]."""

    time: float


class SimulatedCycles:
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
            world.make_step()
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
