"""Smoothed motion by position commands."""

from typing import ClassVar

from typing_extensions import override

from station.controllers.smoothed_motion.jog import JointJogControllerBase
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.controllers.smoothed_motion.streaming import JointStreamingControllerBase
from station.core.hardware.interfaces import PositionJointInterface


class _PositionCommands(SmoothedMotionController[PositionJointInterface]):
    """Commands the smoothed positions."""

    hardware_interface: ClassVar[type] = PositionJointInterface

    @override
    def command(self, actual: list[float], period: float) -> list[float]:
        self.group.set_commands(self.generator.positions)
        return self.generator.positions


class JointStreamingController(
    _PositionCommands, JointStreamingControllerBase[PositionJointInterface]
):
    """Follows streamed positions by position commands."""


class JointJogController(
    _PositionCommands, JointJogControllerBase[PositionJointInterface]
):
    """Jogs joints by position commands."""
