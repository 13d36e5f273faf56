"""Trajectories by commands of position and velocity.

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
    JointStateGroup,
    PosVelJointHandle,
    PosVelJointInterface,
)
from station.core.parameters import Parameters


class JointTrajectoryController(JointTrajectoryControllerBase[PosVelJointInterface]):
    """Commands the desired positions and velocities.

    The `output` of its sample is the positions.
    """

    hardware_interface: ClassVar[type] = PosVelJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._handles: list[PosVelJointHandle] = []
        self._group = JointStateGroup([])

    @override
    def init_joints(self, interface: PosVelJointInterface, params: Parameters) -> None:
        self._handles = [interface.get_handle(name) for name in self.joint_names]
        self._group = JointStateGroup(self._handles)

    @override
    def group(self) -> JointStateGroup:
        return self._group

    @override
    def command(self, execution: TrajectoryExecution, period: float) -> list[float]:
        desired = zip(
            self._handles,
            execution.positions,
            execution.velocities,
            strict=True,
        )
        for handle, position, velocity in desired:
            handle.set_command(position, velocity)
        return execution.positions
