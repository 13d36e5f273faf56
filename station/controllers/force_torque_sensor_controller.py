"""Publish what the robot's force-torque sensors measure at a fixed rate.

Source: ros_controllers@678b92a force_torque_sensor_controller/src/
force_torque_sensor_controller.cpp; geometry_msgs/WrenchStamped.msg.
"""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from typing_extensions import override

from station.core.control.controller import PUBLISH_RATE, Controller
from station.core.declared_parameter import DeclaredParameter
from station.core.hardware.interfaces import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
)
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer


class WrenchStamped(NamedTuple):
    """One measurement of a force-torque sensor.

    Attributes:
        stamp: Station time of the cycle [s].
        frame_id: Frame in which the values are expressed.
        force: Force [N], shape (3,).
        torque: Torque [Nm], shape (3,).
    """

    stamp: float
    frame_id: str
    force: list[float]
    torque: list[float]


class ForceTorqueSensorController(Controller[ForceTorqueSensorInterface]):
    """Publishes all force-torque sensors; commands nothing.

    Parameters: `publish_rate` [Hz], required; nothing is published when the rate is
    not positive.

    Attributes:
        wrenches: The last publication by sensor name, a new object each time; empty
            before the first. Any thread may read it.

    Source:
        ForceTorqueSensorController; differs: missed publications are not made
        up for in a burst, and a restart keeps the times of publication.
    """

    hardware_interface: ClassVar[type] = ForceTorqueSensorInterface

    def __init__(self) -> None:
        super().__init__()
        self.wrenches: dict[str, WrenchStamped] = {}
        self._timer = PublishTimer(0.0)
        self._sensors: list[ForceTorqueSensorHandle] = []

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), PUBLISH_RATE)

    @override
    def init(self, interface: ForceTorqueSensorInterface, params: Parameters) -> None:
        self._timer = PublishTimer(PUBLISH_RATE.read_float(params))
        self._sensors = [interface.get_handle(name) for name in interface.get_names()]

    @override
    def starting(self, time: float) -> None:
        self._timer.start(time, at_once=False)

    @override
    def update(self, time: float, period: float) -> None:
        """Publish when a publication is due."""
        if self._timer.is_due(time):
            self.wrenches = {
                sensor.name: WrenchStamped(
                    time, sensor.get_frame_id(), sensor.get_force(), sensor.get_torque()
                )
                for sensor in self._sensors
            }

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        return {name: wrench._asdict() for name, wrench in self.wrenches.items()}
