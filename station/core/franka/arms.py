"""The Franka arms of a station, for any thread: state, model, and simulation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.core.errors import ArmCommandError, ArmNotFoundError, suggest
from station.core.facade.robots import Robots
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import (
    ArmSimulation,
    CollisionBehavior,
    FaultKind,
    FrankaServices,
    SimulatedFault,
)
from station.reports import ArmRecord


@dataclass(frozen=True, slots=True)
class ArmReport:
    """A summary of an arm.

    Attributes:
        arm_id: Name of the arm.
        robot_mode: Mode of the arm.
        is_connected: Whether the arm is connected.
        errors: The present errors; if there are none, those that ended the last motion.
        remedy: Step needed before the arm can move; None if it can move.
        caution: Error that is about to be raised, and a remedy; None if there is none.
    """

    arm_id: str
    robot_mode: RobotMode
    is_connected: bool
    errors: tuple[ArmError, ...]
    remedy: str | None
    caution: str | None = None


@dataclass(frozen=True, slots=True)
class ArmModelReport:
    """Dynamics and kinematics of an arm in its present state; matrices column-major.

    Attributes:
        frame: Frame of the pose and the Jacobians.
        mass: Mass matrix [kg m^2], shape (49,).
        coriolis: Coriolis torques [Nm], shape (7,).
        gravity: Torques that hold the arm against O_ddP_O [Nm], shape (7,).
        pose: Pose of the frame in the base frame, shape (16,).
        zero_jacobian: Jacobian in the axes of the base, shape (42,).
        body_jacobian: Jacobian in the axes of the frame, shape (42,).
    """

    frame: Frame
    mass: list[float]
    coriolis: list[float]
    gravity: list[float]
    pose: list[float]
    zero_jacobian: list[float]
    body_jacobian: list[float]


class Arms:
    """The Franka arms of one station.

    Every method with an `arm_id` raises `ArmNotFoundError` if there is no such arm, and
    `LoopError` if the loop died or hangs. Methods for simulated arms raise
    `ArmCommandError` if the arm is not simulated.

    Args:
        robots: The robots of the station.
    """

    def __init__(self, robots: Robots) -> None:
        self._robots = robots

    def names(self) -> list[str]:
        """Return the names of the arms."""
        return self._robots.names(FrankaServices)

    def reports(self) -> list[ArmReport]:
        """Return a summary of every arm."""
        return [self.report(arm_id) for arm_id in self.names()]

    def report(self, arm_id: str) -> ArmReport:
        """Return a summary of an arm."""
        arm = self._find(arm_id)
        return ArmReport(
            arm.name,
            arm.robot_mode(),
            arm.is_connected(),
            tuple(arm.errors()),
            arm.remedy(),
            _caution(arm.near_errors()),
        )

    def state(self, arm_id: str) -> RobotState:
        """Return a copy of the complete state of an arm."""
        return self._robots.run(self._find(arm_id).get_robot_state)

    def log(self, arm_id: str) -> list[ArmRecord]:
        """Return the last cycles before the last error of an arm."""
        return self._robots.run(self._find(arm_id).log)

    def model(self, arm_id: str, frame: Frame) -> ArmModelReport:
        """Return the model of an arm, evaluated in its present state."""
        arm = self._find(arm_id)

        def evaluate() -> ArmModelReport:
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

        return self._robots.run(evaluate)

    def set_collision_behavior(self, arm_id: str, behavior: CollisionBehavior) -> None:
        """Set the thresholds of contact and collision; see `FrankaServices`."""
        arm = self._find(arm_id)
        self._robots.run(lambda: arm.set_collision_behavior(behavior))

    def set_user_stop(self, arm_id: str, *, pressed: bool) -> None:
        """Press or release the user stop of a simulated arm; see `ArmSimulation`.

        Both make every earlier command void.
        """
        arm, simulation = self._find(arm_id), self._simulation(arm_id)
        did = "pressed" if pressed else "released"

        def press() -> None:
            simulation.set_user_stop(pressed=pressed)
            # A person at the arm has ended the motion, so a later recovery must not
            # resume it.
            if not pressed:
                self._robots.forget_interrupted()

        reason = f"The user stop of arm '{arm_id}' was {did}."
        self._robots.run(press, voids=reason)
        self._robots.wait_until_recovered(arm)

    def set_guiding(self, arm_id: str, *, pressed: bool) -> None:
        """Press or release the guiding buttons of a simulated arm."""
        simulation = self._simulation(arm_id)
        self._robots.run(lambda: simulation.set_guiding(pressed=pressed))

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
        push = self._simulation(arm_id).apply_force
        self._robots.run(
            lambda: push(link, force, torque, duration, frame=frame, point=point)
        )

    def faults(self, arm_id: str) -> list[SimulatedFault]:
        """Return the active faults of a simulated arm."""
        return self._robots.run(self._simulation(arm_id).faults)

    def inject(self, arm_id: str, fault: SimulatedFault) -> None:
        """Inject a fault into a simulated arm; see `ArmSimulation`."""
        simulation = self._simulation(arm_id)

        def begin() -> None:
            simulation.inject(fault)
            if fault.kind is FaultKind.DELAYED_CYCLE:
                self._robots.delay_next_cycle(fault.cycles)

        self._robots.run(begin)

    def clear_faults(self, arm_id: str) -> None:
        """End all faults of a simulated arm, and all pushes."""
        self._robots.run(self._simulation(arm_id).clear_faults)

    def reader(self, arm_id: str) -> Callable[[], RobotState]:
        """Return a function that copies an arm's state; it is for the control thread.

        Raises:
            ArmNotFoundError: There is no such arm.
        """
        return self._find(arm_id).get_robot_state

    def _find(self, arm_id: str) -> FrankaServices:
        kind: type[FrankaServices] = FrankaServices  # type: ignore[type-abstract]
        arm = self._robots.get(arm_id, kind)
        if arm is None:
            raise ArmNotFoundError(
                f"Robot '{arm_id}' is no Franka arm.",
                remedy=suggest(arm_id, self.names()),
                details={"arm_id": arm_id},
            )
        return arm

    def _simulation(self, arm_id: str) -> ArmSimulation:
        simulation = self._find(arm_id).simulation()
        if simulation is None:
            raise ArmCommandError(
                f"Arm '{arm_id}' is not simulated.", remedy="Do it by hand."
            )
        return simulation


def _caution(near: Sequence[ArmError]) -> str | None:
    if not near:
        return None
    found = "; ".join(
        f"{one.name} at {one.where} is raised above {one.limit:.6g} {one.unit}, and "
        f"the estimate is {one.value:.3g} {one.unit}"
        for one in near
    )
    return (
        f"{found}. Remove what touches the arm, or raise the thresholds with "
        "set_force_torque_collision_behavior."
    )
