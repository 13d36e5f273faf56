"""The base of the controllers that close one PID loop around every joint."""

from collections.abc import Mapping
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
    JointSetPointController,
)
from station.controllers.pid_command_controller.joint_pids import (
    JointPids,
    read_joint_pids,
)
from station.core.control.controller import ControllerSample
from station.core.control.tunables import Tunable
from station.core.parameters import Parameters


class JointPidController(JointSetPointController[CommandInterfaceT]):
    """Computes commands from the errors of the quantity it controls.

    Attributes:
        quantity: What is controlled: set-points, measured values and errors.
        command_quantity: What the PIDs compute.
    """

    command_quantity: ClassVar[JointQuantity]

    def __init__(self) -> None:
        super().__init__()
        self._period = 0.0
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self._pids = JointPids(
            self.joints,
            read_joint_pids(params, self.joints),
            error=self.quantity,
            command=self.command_quantity,
        )

    def errors(self, set_point: list[float], actual: list[float]) -> list[float]:
        """Return what is missing to the set-point, shape (n,); a plain difference."""
        return [d - a for d, a in zip(set_point, actual, strict=True)]

    @override
    def starting(self, time: float) -> None:
        super().starting(time)
        self._pids.reset()

    @override
    def update(self, time: float, period: float) -> None:
        set_point = self.newest_set_point()
        actual = self.quantity.measure(self.group)
        errors = self.errors(set_point, actual)
        if self.rates:
            measured = self.group.get_velocities()
            missing = [d - a for d, a in zip(self.rates, measured, strict=True)]
            commands = self._pids.compute_commands_with_rates(errors, missing, period)
        else:
            commands = self._pids.compute_commands(errors, period)
        self.group.set_commands(commands)
        self._period = period
        self.sample = ControllerSample(time, set_point, actual, errors, commands)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state`; for a group lists, in the order of its joints.

        Source:
            control_msgs@1.5.2 msg/JointControllerState.msg; differs: a group of joints
            publishes its state, too.
        """
        sample = self.sample
        if sample is None:
            return {}
        columns: dict[str, list[float] | list[bool]] = {
            "set_point": sample.desired,
            "process_value": sample.actual,
            "error": sample.error,
            "command": sample.output,
            **self._pids.columns(),
        }
        common = {"stamp": sample.stamp, "time_step": self._period}
        if self.is_group:
            return {"state": {**common, "joint_names": self.joint_names, **columns}}
        return {"state": {**common, **{key: each[0] for key, each in columns.items()}}}

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
