"""Grippers by effort commands.

Source: ros_controllers@678b92a gripper_action_controller/hardware_interface_adapter.h.
"""

from collections.abc import Mapping
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.gripper_action_controller.gripper_action_controller import (
    GripperActionControllerBase,
)
from station.controllers.gripper_action_controller.gripper_command_port import (
    GripperCommand,
)
from station.controllers.pid_command_controller import JointPids, read_joint_pids
from station.core.control.tunables import Tunable
from station.core.hardware.interfaces import EffortJointInterface, JointHandle
from station.core.parameters import Parameters


class GripperActionController(GripperActionControllerBase[EffortJointInterface]):
    """Commands what a PID makes of the error, at most the effort of the goal.

    Parameters, besides those of the base: `gains/<joint>` with `p`, `i`, `d`,
    `i_clamp` …
    """

    hardware_interface: ClassVar[type] = EffortJointInterface

    def __init__(self) -> None:
        super().__init__()
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )

    @override
    def init_command(self, params: Parameters) -> None:
        self._pids = JointPids(
            [self.joint],
            read_joint_pids(params, [self.joint]),
            error=JointQuantity.POSITION,
            command=JointQuantity.EFFORT,
        )

    @override
    def reset_command(self) -> None:
        self._pids.reset()

    @override
    def command(
        self, handle: JointHandle, target: GripperCommand, period: float
    ) -> float:
        error = target.position - handle.get_position()
        (wanted,) = self._pids.compute_commands_with_rates(
            [error], [-handle.get_velocity()], period
        )
        effort = max(-target.max_effort, min(target.max_effort, wanted))
        handle.set_command(effort)
        return effort

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
