"""Trajectories by position commands.

Source: ros_controllers@678b92a joint_trajectory_controller/
hardware_interface_adapter.h.
"""

from typing import ClassVar

from typing_extensions import override

from station.controllers.joint_trajectory_controller.joint_trajectory_controller import (  # noqa: E501
    JointTrajectoryControllerBase,
)
from station.controllers.joint_trajectory_controller.trajectory_execution import (
    TrajectoryExecution,
)
from station.core.hardware.interfaces import (
    JointGroup,
    JointStateGroup,
    PositionJointInterface,
)
from station.core.parameters import Parameters


class JointTrajectoryController(JointTrajectoryControllerBase[PositionJointInterface]):
    """Commands the desired positions."""

    hardware_interface: ClassVar[type] = PositionJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._group = JointGroup([])

    @override
    def init_joints(
        self, interface: PositionJointInterface, params: Parameters
    ) -> None:
        self._group = JointGroup([interface.get_handle(n) for n in self.joint_names])

    @override
    def group(self) -> JointStateGroup:
        return self._group

    @override
    def command(self, execution: TrajectoryExecution, period: float) -> list[float]:
        self._group.set_commands(execution.positions)
        return execution.positions
