"""Smoothed motion by effort commands."""

from collections.abc import Mapping
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import JointPids, read_joint_pids
from station.controllers.smoothed_motion.jog import JointJogControllerBase
from station.controllers.smoothed_motion.motion_limits import read_max_lead
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.controllers.smoothed_motion.streaming import JointStreamingControllerBase
from station.core.control.tunables import Tunable
from station.core.hardware.interfaces import EffortJointInterface
from station.core.parameters import Parameters


class _EffortCommands(SmoothedMotionController[EffortJointInterface]):
    """Commands what PIDs make of the errors of position and velocity.

    A joint that is blocked is not run away from: the desired motion waits while one
    is too far behind, and goes on when the joint has come nearer or the set-point leads
    back.

    Parameters, besides those of the base: the gains of every joint, see
    `read_joint_pids`; `max_lead`, see `read_max_lead`.
    """

    hardware_interface: ClassVar[type] = EffortJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._max_lead: list[float] = []
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        super().init(interface, params)
        self._max_lead = read_max_lead(params, self.joints)
        self._pids = JointPids(
            self.joints,
            read_joint_pids(params, self.joints),
            error=JointQuantity.POSITION,
            command=JointQuantity.EFFORT,
        )

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        if self._runs_away(set_point):
            self.wait()
        else:
            super().steer(set_point, period)

    def _runs_away(self, set_point: list[float]) -> bool:
        """Say whether a joint is too far behind and would fall behind further."""
        ahead = zip(
            self.generator.positions,
            self.group.get_positions(),
            self.heading(set_point),
            self._max_lead,
            strict=True,
        )
        return any(
            abs(desired - actual) > bound and (desired - actual) * direction > 0.0
            for desired, actual, direction, bound in ahead
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
