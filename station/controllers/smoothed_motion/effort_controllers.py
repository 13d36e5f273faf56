"""Smoothed motion by effort commands."""

from collections.abc import Mapping
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import JointPids, read_joint_pids
from station.controllers.smoothed_motion.jog import JointJogControllerBase
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.controllers.smoothed_motion.streaming import JointStreamingControllerBase
from station.core.interfaces import EffortJointInterface
from station.core.parameters import Parameters
from station.core.tunables import Tunable


class _EffortCommands(SmoothedMotionController[EffortJointInterface]):
    """Commands what PIDs make of the errors of position and velocity.

    Parameters, besides those of the base: the gains of every joint, see
    `read_joint_pids`.
    """

    hardware_interface: ClassVar[type] = EffortJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        super().init(interface, params)
        self._pids = JointPids(
            self.joints,
            read_joint_pids(params, self.joints),
            error=JointQuantity.POSITION,
            command=JointQuantity.EFFORT,
        )

    @override
    def reset_command(self) -> None:
        self._pids.reset()

    @override
    def command(self, actual: list[float], period: float) -> list[float]:
        wanted = self.generator
        errors = [d - a for d, a in zip(wanted.positions, actual, strict=True)]
        measured = self.group.get_velocities()
        rates = [d - a for d, a in zip(wanted.velocities, measured, strict=True)]
        efforts = self._pids.compute_commands_with_rates(errors, rates, period)
        self.group.set_commands(efforts)
        return efforts

    @override
    def gain_schema(self) -> Mapping[str, Tunable]:
        return self._pids.gain_schema()

    @override
    def gains(self) -> dict[str, float]:
        return self._pids.gains()

    @override
    def check_gains(self, values: Mapping[str, float]) -> None:
        self._pids.check_gains(values)

    @override
    def apply_gains(self, values: Mapping[str, float]) -> None:
        self._pids.apply_gains(values)


class JointStreamingController(
    _EffortCommands, JointStreamingControllerBase[EffortJointInterface]
):
    """Follows streamed positions by effort commands."""


class JointJogController(_EffortCommands, JointJogControllerBase[EffortJointInterface]):
    """Jogs joints by effort commands."""
