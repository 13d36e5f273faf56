"""Publish the readings of force-torque sensors: all at a rate, or one filtered.

Source: ros_controllers@678b92a force_torque_sensor_controller/src/
force_torque_sensor_controller.cpp; ros2_controllers@4.x
force_torque_sensor_broadcaster/src/force_torque_sensor_broadcaster.cpp;
geometry_msgs/WrenchStamped.msg.
"""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from typing_extensions import override

from station.core.control.controller import PUBLISH_RATE, Controller
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_mappings,
    declare_number,
    declare_string,
)
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
)
from station.core.parameters import Parameters
from station.core.toolbox.filters import FilterChain
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

    own_parameters = (PUBLISH_RATE,)

    @override
    def init(self, interface: ForceTorqueSensorInterface, params: Parameters) -> None:
        self.wrenches: dict[str, WrenchStamped] = {}
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


SENSOR_NAME = declare_string("sensor_name", "the sensor")
FRAME_ID = declare_string("frame_id", "name of the frame of the published values", "")
"""Two parameters that every broadcaster of one sensor has."""
_FILTERS = declare_mappings(
    "sensor_filter_chain", "filters of what is measured", default_text="none"
)
_AXES = tuple(f"{kind}/{axis}" for kind in ("force", "torque") for axis in "xyz")


def _corrections(name: str, default: float, text: str) -> list[DeclaredParameter]:
    return [
        declare_number(
            f"{name}/{axis}",
            text,
            default,
            "" if name == "multiplier" else "N" if "force" in axis else "Nm",
        )
        for axis in _AXES
    ]


_OFFSET = _corrections("offset", 0.0, "is added to what is measured")
_MULTIPLIER = _corrections("multiplier", 1.0, "factor of what is measured and added")


class ForceTorqueSensorBroadcaster(Controller[ForceTorqueSensorInterface]):
    """Publishes one sensor in every cycle, as it is and filtered; commands nothing.

    The published value is `(measured + offset) * multiplier`.

    Source:
        ForceTorqueSensorBroadcaster; differs: a robot has whole sensors, so that
        `interface_names` has no effect.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = (
        "interface_names",
        "state_publish_rate",
        "publish_rate",
    )
    own_parameters = (SENSOR_NAME, FRAME_ID, _FILTERS, *_OFFSET, *_MULTIPLIER)

    @override
    def init(self, interface: ForceTorqueSensorInterface, params: Parameters) -> None:
        self._sensor = interface.get_handle(SENSOR_NAME.read_str(params))
        self._frame = FRAME_ID.read_str(params) or self._sensor.get_frame_id()
        self._filters = FilterChain.read(
            params.get(_FILTERS.name), params.resolve(_FILTERS.name)
        )
        self._offset = [each.read_float(params) for each in _OFFSET]
        self._multiplier = [each.read_float(params) for each in _MULTIPLIER]

    @override
    def starting(self, time: float) -> None:
        self._filters.reset()

    @override
    def update(self, time: float, period: float) -> None:
        measured = self._sensor.get_force() + self._sensor.get_torque()
        values = [
            (value + offset) * factor
            for value, offset, factor in zip(
                measured, self._offset, self._multiplier, strict=True
            )
        ]
        filtered = self._filters.update(values)
        self.messages = {
            name: WrenchStamped(time, self._frame, each[:3], each[3:])._asdict()
            for name, each in (("wrench", values), ("wrench_filtered", filtered))
        }
