"""Trajectories by a PID per joint and a share of the desired velocity.

Source: ros_controllers@678b92a joint_trajectory_controller/
hardware_interface_adapter.h, ClosedLoopHardwareInterfaceAdapter.
"""

from collections.abc import Mapping
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.joint_trajectory_controller.joint_trajectory_controller import (  # noqa: E501
    JointTrajectoryControllerBase,
)
from station.controllers.joint_trajectory_controller.trajectory_execution import (
    TrajectoryExecution,
)
from station.controllers.pid_command_controller import JointPids, read_joint_pids
from station.core.control.tunables import Tunable
from station.core.hardware.interfaces import (
    JointCommandInterface,
    JointGroup,
    JointStateGroup,
)
from station.core.parameters import Parameters

CommandInterfaceT = TypeVar("CommandInterfaceT", bound=JointCommandInterface)


class ClosedLoopTrajectoryController(JointTrajectoryControllerBase[CommandInterfaceT]):
    """Commands what PIDs make of the errors, plus `velocity_ff` times the velocity.

    Parameters, besides those of the base: `gains/<joint>` with `p`, `i`, `d`,
    `i_clamp` …; `velocity_ff/<joint>`, 0 by default.

    Attributes:
        command_quantity: What is commanded.

    Source:
        ClosedLoopHardwareInterfaceAdapter; differs: missing gains are refused when the
        controller is loaded.
    """

    command_quantity: ClassVar[JointQuantity]

    def __init__(self) -> None:
        super().__init__()
        self._group = JointGroup([])
        self._velocity_ff: list[float] = []
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )

    @override
    def init_joints(self, interface: CommandInterfaceT, params: Parameters) -> None:
        self._group = JointGroup([interface.get_handle(n) for n in self.joint_names])
        self._pids = JointPids(
            self.joints,
            read_joint_pids(params, self.joints),
            error=JointQuantity.POSITION,
            command=self.command_quantity,
        )
        self._velocity_ff = [
            params.get_float(f"velocity_ff/{name}", 0.0) for name in self.joint_names
        ]

    @override
    def group(self) -> JointStateGroup:
        return self._group

    @override
    def reset_command(self) -> None:
        self._pids.reset()

    @override
    def command(self, execution: TrajectoryExecution, period: float) -> list[float]:
        errors = execution.errors
        corrections = self._pids.compute_commands_with_rates(
            errors.positions, errors.velocities, period
        )
        commands = [
            share * velocity + correction
            for share, velocity, correction in zip(
                self._velocity_ff, execution.velocities, corrections, strict=True
            )
        ]
        self._group.set_commands(commands)
        return commands

    @override
    def command_gain_schema(self) -> Mapping[str, Tunable]:
        return self._pids.gain_schema()

    @override
    def command_gains(self) -> dict[str, float]:
        return self._pids.gains()

    @override
    def check_gains(self, values: Mapping[str, float]) -> None:
        self._pids.check_gains(values)

    @override
    def apply_command_gains(self, values: Mapping[str, float]) -> None:
        self._pids.apply_gains(values)
