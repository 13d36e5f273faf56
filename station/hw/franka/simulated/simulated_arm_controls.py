"""The controls that only a simulated arm has: its buttons, pushes and faults."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.franka.arm_simulation import ArmSimulation, SimulatedFault
from station.hw.franka.simulated.arm_modes import ArmModes
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.push import WORLD, as_push
from station.hw.mujoco.world import World


class SimulatedArmControls(ArmSimulation):
    """The buttons, pushes and faults of one simulated arm. Control thread only.

    Args:
        world: The world of the arm.
        modes: The modes of the arm.
        faults: The faults of the arm.
    """

    def __init__(self, world: World, modes: ArmModes, faults: SensorFaults) -> None:
        self._world = world
        self._modes = modes
        self._faults = faults

    @override
    def set_user_stop(self, *, pressed: bool) -> None:
        self._modes.set_user_stop(pressed=pressed)

    @override
    def set_guiding(self, *, pressed: bool) -> None:
        self._modes.set_guiding(pressed=pressed)

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
        push = as_push(link, force, torque, frame=frame, point=point)
        self._world.push(push, max(1, round(duration / self._world.timestep)))

    @override
    def inject(self, fault: SimulatedFault) -> None:
        self._faults.inject(fault)

    @override
    def faults(self) -> list[SimulatedFault]:
        return self._faults.active()

    @override
    def clear_faults(self) -> None:
        self._faults.clear()
