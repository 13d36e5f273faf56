"""The controls that only a simulated arm has: buttons, pushes and faults."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.errors import InvalidCommandError
from station.core.franka.franka_services import ArmSimulation, FaultKind, SimulatedFault
from station.core.hardware.robot_report import ClampReport
from station.hw.franka.arm.service_limits import (
    PUSH_DISTANCE,
    ServiceLimits,
    check_vector,
    field_error,
)
from station.hw.franka.simulated.arm_modes import ArmModes
from station.hw.franka.simulated.arm_parts import ArmParts
from station.hw.mujoco.push import WORLD, as_push
from station.hw.mujoco.world import World


class SimulatedArmControls(ArmSimulation):
    """The buttons, pushes and faults of one simulated arm. Control thread only.

    Args:
        world: The world of the arm.
        parts: The parts of the arm.
        modes: The modes of the arm.
        limits: The largest pushes.
    """

    def __init__(
        self, world: World, parts: ArmParts, modes: ArmModes, limits: ServiceLimits
    ) -> None:
        self._joint_names = parts.joint_names
        self._step = parts.step
        self._world = world
        self._limits = limits
        self._modes = modes
        self._faults = parts.faults

    @override
    def set_user_stop(self, *, pressed: bool) -> None:
        self._modes.set_user_stop(pressed=pressed)

    @override
    def set_guiding(self, *, pressed: bool) -> None:
        self._modes.set_guiding(pressed=pressed)

    @override
    def set_brakes(self, *, closed: bool) -> None:
        self._modes.set_brakes(closed=closed)

    @override
    def apply_force(
        self,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = WORLD,
        point: Sequence[float] | None = None,
    ) -> None:
        self._check_force(force)
        largest = self._limits.push_torque
        check_vector(
            torque, largest, field="torque", what="torque of a push", unit="Nm"
        )
        if point is not None:
            check_vector(
                point, PUSH_DISTANCE, field="point", what="point of a push", unit="m"
            )
        self._check_duration(duration)
        push = as_push(link, force, torque, frame=frame, point=point)
        self._world.push(push, max(1, round(duration / self._world.timestep)))

    @override
    def inject(self, fault: SimulatedFault) -> None:
        if fault.kind is FaultKind.COLLISION:
            self._check_force(fault.force)
        self._faults.inject(fault)
        self._step.has_faults = self._faults.act

    @override
    def faults(self) -> list[SimulatedFault]:
        return self._faults.active()

    @override
    def clear_faults(self) -> None:
        self._faults.clear()
        self._step.has_faults = False

    def _check_force(self, force: Sequence[float]) -> None:
        largest = self._limits.push_force
        check_vector(force, largest, field="force", what="force of a push", unit="N")

    def _check_duration(self, duration: float) -> None:
        longest = self._limits.push_duration
        if not 0.0 < duration <= longest:
            allowed = f"above 0 s and at most {longest:g} s"
            raise InvalidCommandError(
                f"A push of {duration} s is not possible; allowed is {allowed}.",
                remedy="Choose a duration in this range.",
                details=field_error("duration", f"must be {allowed}", duration),
            )

    @override
    def clamps(self) -> list[ClampReport]:
        return self._world.brakes.clamps(self._joint_names)
