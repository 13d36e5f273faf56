"""The arms of the station, for any thread: state, model, settings, recovery.

Every method carries its work out between two cycles, and either does the whole thing or
raises and changes nothing.
"""
# ruff: noqa: N802, N803 - NE_T_EE, EE_T_K, F_x_center_load are libfranka's names.

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import ArmCommandError, ArmNotFoundError
from station.core.franka import (
    ArmError,
    ArmRecord,
    ArmSimulation,
    CollisionBehavior,
    FaultKind,
    Frame,
    FrankaServices,
    FrankaServicesInterface,
    RobotMode,
    RobotState,
    SimulatedFault,
)
from station.core.loop.control_loop import ControlLoop

T = TypeVar("T")
_LONGEST_RECOVERY = 2_000
"""Cycles after which an arm that recovers is at rest for sure."""


@dataclass(frozen=True, slots=True)
class ArmReport:
    """An arm at a glance.

    Attributes:
        arm_id: Its name.
        mode: What it is doing.
        is_connected: Whether it may be used.
        errors: What its present errors, or else the last motion's, came from.
        remedy: What to do before the arm can move; None when it can move.
    """

    arm_id: str
    mode: RobotMode
    is_connected: bool
    errors: tuple[ArmError, ...]
    remedy: str | None


@dataclass(frozen=True, slots=True)
class ArmModelReport:
    """What the model of an arm says in its present state; matrices column-major.

    Attributes:
        frame: Frame of the pose and the Jacobians.
        mass: [kg m^2], shape (49,).
        coriolis: [Nm], shape (7,).
        gravity: That hold the arm where it is mounted, O_ddP_O [Nm], shape (7,).
        pose: Of the frame in the base frame, shape (16,).
        zero_jacobian: Axes of the base, shape (42,).
        body_jacobian: Axes of the frame, shape (42,).
    """

    frame: Frame
    mass: list[float]
    coriolis: list[float]
    gravity: list[float]
    pose: list[float]
    zero_jacobian: list[float]
    body_jacobian: list[float]


class Robots:
    """The arms of one station.

    Args:
        loop: The loop.
        manager: Its controller manager.
    """

    def __init__(self, loop: ControlLoop, manager: ControllerManager) -> None:
        self._loop = loop
        self._manager = manager
        found = loop.hw.get(FrankaServicesInterface)
        arms = found.handles() if found else []
        self._arms: dict[str, FrankaServices] = {arm.name: arm for arm in arms}

    def names(self) -> list[str]:
        """Return the names of the arms."""
        return list(self._arms)

    def reports(self) -> list[ArmReport]:
        """Return all arms at a glance."""
        return [_report(arm) for arm in self._arms.values()]

    def report(self, arm_id: str) -> ArmReport:
        """Return an arm at a glance.

        Raises:
            ArmNotFoundError: There is no such arm.
        """
        return _report(self._find(arm_id))

    def state(self, arm_id: str) -> RobotState:
        """Return a copy of an arm's whole state.

        Raises:
            ArmNotFoundError: There is no such arm.
        """
        return self._ask(arm_id, lambda arm: arm.get_robot_state())

    def log(self, arm_id: str) -> list[ArmRecord]:
        """Return the last cycles before the last error of an arm.

        Raises:
            ArmNotFoundError: There is no such arm.
        """
        return self._ask(arm_id, lambda arm: arm.log())

    def model(self, arm_id: str, frame: Frame) -> ArmModelReport:
        """Return what the model of an arm says in its present state.

        Raises:
            ArmNotFoundError: There is no such arm.
        """

        def evaluate(arm: FrankaServices) -> ArmModelReport:
            model = arm.model()
            return ArmModelReport(
                frame,
                model.get_mass(),
                model.get_coriolis(),
                model.get_gravity(arm.get_robot_state().O_ddP_O),
                model.get_pose(frame),
                model.get_zero_jacobian(frame),
                model.get_body_jacobian(frame),
            )

        return self._ask(arm_id, evaluate)

    def set_joint_impedance(self, arm_id: str, stiffness: Sequence[float]) -> None:
        """Set the internal joint impedance; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_joint_impedance(stiffness))

    def set_cartesian_impedance(self, arm_id: str, stiffness: Sequence[float]) -> None:
        """Set the internal Cartesian impedance; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_cartesian_impedance(stiffness))

    def set_EE_frame(self, arm_id: str, NE_T_EE: Sequence[float]) -> None:
        """Set the end effector frame; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_EE_frame(NE_T_EE))

    def set_K_frame(self, arm_id: str, EE_T_K: Sequence[float]) -> None:
        """Set the stiffness frame; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_K_frame(EE_T_K))

    def set_load(
        self,
        arm_id: str,
        mass: float,
        F_x_center_load: Sequence[float],
        load_inertia: Sequence[float],
    ) -> None:
        """Set what the hand holds; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_load(mass, F_x_center_load, load_inertia))

    def set_collision_behavior(self, arm_id: str, behavior: CollisionBehavior) -> None:
        """Set the thresholds of contact and collision; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.set_collision_behavior(behavior))

    def recover(self, arm_id: str, *, restart: bool = False) -> tuple[str, ...]:
        """Clear an arm's errors; every command from before is void.

        Nothing happens when there is no error. Returns when the arm is at rest, or at
        once while time is paused.

        Args:
            arm_id: The arm.
            restart: Start the controllers again that the interruption stopped, with an
                update whose period is zero first; otherwise they stay stopped.

        Returns:
            Names of the controllers that were started again.

        Raises:
            ArmNotFoundError: There is no such arm.
            ArmCommandError: The arm cannot recover itself now.
            StoppedError: The station is stopped and controllers were to be started.
            SwitchRefusedError: The controllers cannot be started; the arm recovered.
        """
        return self._recover([self._find(arm_id)], restart=restart)

    def recover_all(self, *, restart: bool = False) -> tuple[str, ...]:
        """Clear the errors of all arms, or of none if one of them cannot recover.

        Args:
            restart: As for `recover`.

        Returns:
            Names of the controllers that were started again.

        Raises:
            ArmCommandError: An arm cannot recover itself now.
            StoppedError: The station is stopped and controllers were to be started.
            SwitchRefusedError: The controllers cannot be started; the arms recovered.
        """
        return self._recover(list(self._arms.values()), restart=restart)

    def _recover(
        self, arms: Sequence[FrankaServices], *, restart: bool
    ) -> tuple[str, ...]:
        if restart:
            self._loop.stop_latch.check()

        def clear() -> bool:
            for arm in arms:
                arm.check_recovery()
            recovered = [arm.name for arm in arms if arm.error_recovery()]
            if recovered:
                names = "' and '".join(recovered)
                did = "was" if len(recovered) == 1 else "were"
                self._loop.next_epoch(f"Arm '{names}' {did} recovered.")
            return bool(recovered)

        if not self._loop.run_in_cycle(clear):
            return ()
        for arm in arms:
            self._wait_until_recovered(arm)
        names = self._manager.interrupted if restart else ()
        if names:
            request = SwitchRequest(names, (), zero_period=True)
            names = self._manager.switch_controller(request).started
        if restart or all(not arm.remedy() for arm in self._arms.values()):
            self._manager.forget_interrupted()
        return names

    def _wait_until_recovered(self, arm: FrankaServices) -> None:
        for _ in range(_LONGEST_RECOVERY):
            is_done = arm.robot_mode() is not RobotMode.AUTOMATIC_ERROR_RECOVERY
            if is_done or self._loop.pace.paused:
                return
            if self._manager.pump is not None:
                self._manager.pump()
            else:
                self._loop.run_in_cycle(lambda: None)
        raise ArmCommandError(
            f"Arm '{arm.name}' did not come to rest.", remedy="Recover once more."
        )

    def set_user_stop(self, arm_id: str, *, pressed: bool) -> None:
        """Press or release the user stop of an arm; see `ArmSimulation`."""

        def press(arm: ArmSimulation) -> None:
            arm.set_user_stop(pressed=pressed)
            did = "pressed" if pressed else "released"
            self._loop.next_epoch(f"The user stop of arm '{arm_id}' was {did}.")
            if not pressed:
                self._manager.forget_interrupted()

        self._ask_simulation(arm_id, press)
        self._wait_until_recovered(self._find(arm_id))

    def connect(self, arm_id: str) -> None:
        """Connect to an arm; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.connect())

    def disconnect(self, arm_id: str) -> None:
        """Give an arm up; see `FrankaServices`."""
        self._ask(arm_id, lambda arm: arm.disconnect())

    def set_guiding(self, arm_id: str, *, pressed: bool) -> None:
        """Hold or let go of an arm's guiding buttons; see `ArmSimulation`."""
        self._ask_simulation(arm_id, lambda arm: arm.set_guiding(pressed=pressed))

    def apply_force(
        self,
        arm_id: str,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = "world",
        point: Sequence[float] | None = None,
    ) -> None:
        """Push a link of a simulated arm; see `ArmSimulation`."""
        self._ask_simulation(
            arm_id,
            lambda arm: arm.apply_force(
                link, force, torque, duration, frame=frame, point=point
            ),
        )

    def faults(self, arm_id: str) -> list[SimulatedFault]:
        """Return what goes wrong with a simulated arm; see `ArmSimulation`."""
        return self._ask_simulation(arm_id, lambda arm: arm.faults())

    def inject(self, arm_id: str, fault: SimulatedFault) -> None:
        """Make something go wrong with a simulated arm; see `ArmSimulation`."""

        def begin(arm: ArmSimulation) -> None:
            arm.inject(fault)
            if fault.kind is FaultKind.DELAYED_CYCLE:
                self._loop.delay_next_cycle(fault.cycles)

        self._ask_simulation(arm_id, begin)

    def clear_faults(self, arm_id: str) -> None:
        """End what was made to go wrong with a simulated arm, and every push."""
        self._ask_simulation(arm_id, lambda arm: arm.clear_faults())

    def _ask(self, arm_id: str, action: Callable[[FrankaServices], T]) -> T:
        arm = self._find(arm_id)
        return self._loop.run_in_cycle(lambda: action(arm))

    def _ask_simulation(self, arm_id: str, action: Callable[[ArmSimulation], T]) -> T:
        return self._ask(arm_id, lambda arm: action(_simulation_of(arm)))

    def _find(self, arm_id: str) -> FrankaServices:
        arm = self._arms.get(arm_id)
        if arm is None:
            raise ArmNotFoundError(
                f"There is no arm '{arm_id}'.",
                remedy=f"The arms are: {', '.join(self._arms) or 'none'}.",
                details={"arm_id": arm_id},
            )
        return arm


def _report(arm: FrankaServices) -> ArmReport:
    return ArmReport(
        arm.name,
        arm.robot_mode(),
        arm.is_connected(),
        tuple(arm.errors()),
        arm.remedy(),
    )


def _simulation_of(arm: FrankaServices) -> ArmSimulation:
    simulation = arm.simulation()
    if simulation is None:
        raise ArmCommandError(
            f"Arm '{arm.name}' is not simulated.", remedy="Do it by hand."
        )
    return simulation
