"""Bring the state of a simulated arm up to date, once per cycle."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.friction_and_observer import (
    LOST,
    TOUCHED,
    WEAK,
    FrictionAndObserver,
)
from station.hw.mujoco.world_step import WorldStep

if TYPE_CHECKING:
    from station.core.franka.franka_robot_state import RobotState
    from station.hw.franka.simulated.contact_estimate import ContactEstimate

# As C numbers, by the .pxd.
_TOUCHED = TOUCHED
_ASKS = WEAK | LOST


class SimulatedCycles:
    """The cycles of a simulated arm.

    Args:
        step: The arm's arithmetic around a step of its world.
        world: The world's steps.
        state: The arm's state; its time is written.
        period: Duration of a cycle [s], > 0.
        contact: Estimates contacts; supervised while it is not quiet.
        read_disturbed: Reads the joints at a time [s] while a load or a fault acts;
            returns the result of `ArmStep.read_joints`.
        observer: Disturbs the readings; None for an ideal arm.
        expect_load: Gives the observer the torques for a configured load.
        react: Carries out the observer's requests, given the result of its `sense`.
        supervise: Finds contacts and errors, given the result of `read_joints`.

    Attributes:
        cycle: Number of the last cycle.
        seen: Number of the step after which the joints were read last.
    """

    def __init__(
        self,
        step: ArmStep,
        world: WorldStep,
        *,
        state: "RobotState",
        period: float,
        contact: "ContactEstimate",
        read_disturbed: Callable[[float], int],
        observer: FrictionAndObserver | None,
        expect_load: Callable[[], None],
        react: Callable[[int], None],
        supervise: Callable[[int], None],
    ) -> None:
        self.step = step
        self.world = world
        self.state = state
        self.period = period
        self.contact = contact
        self.read_disturbed = read_disturbed
        self.observer = observer
        self.expect_load = expect_load
        self.react = react
        self.supervise = supervise
        self.cycle = world.count
        self.seen = world.count

    def read(self) -> "RobotState":
        """Let the world make its step if no other arm has; return the arm's state."""
        world, step = self.world, self.step
        self.cycle += 1
        while world.count < self.cycle:
            world.make_step()
        steps = world.count
        # After a late cycle another arm has led the world on: this state was read
        # already.
        if self.seen >= steps:
            return self.state
        self.seen = steps
        time = steps * self.period
        if step.has_load or step.has_faults:
            found = self.read_disturbed(time)
        else:
            found = step.read_joints(time)
            self.state.time = time
        observer = self.observer
        if observer is not None:
            if step.has_load:
                self.expect_load()
            observed = observer.sense()
            if observed & _TOUCHED:
                self.contact.is_quiet = False
            if observed & _ASKS:
                self.react(observed)
        # What follows is plain Python, and is left out while nothing can have changed.
        if (
            found
            or world.is_pushed
            or world.stands_still
            or step.has_load
            or not self.contact.is_quiet
            or step.watch.is_alert
        ):
            self.supervise(found)
        return self.state
