"""Publish the readings of sensors: wrenches, motions, ranges, fields, places, charge.

Source: ros_controllers@678b92a force_torque_sensor_controller/src/
force_torque_sensor_controller.cpp, imu_sensor_controller/src/imu_sensor_controller.cpp;
ros2_controllers@4.x force_torque_sensor_broadcaster/src/
force_torque_sensor_broadcaster.cpp; ros2_controllers@6.x range_sensor_broadcaster,
magnetometer_broadcaster, gps_sensor_broadcaster, battery_state_broadcaster;
geometry_msgs WrenchStamped.msg; sensor_msgs Imu.msg, Range.msg, MagneticField.msg,
NavSatFix.msg, BatteryState.msg.
"""

from collections.abc import Mapping, Sequence
from math import isfinite, nan
from typing import Any, ClassVar, NamedTuple

from typing_extensions import override

from station.core.control.controller import PUBLISH_RATE, Controller
from station.core.declared_parameter import (
    DeclaredParameter,
    ParameterType,
    declare_boolean,
    declare_mappings,
    declare_number,
    declare_numbers,
    declare_string,
    declare_strings,
)
from station.core.errors import ParameterError, ResourceNotFoundError, suggest
from station.core.hardware.interfaces import (
    BatterySensorInterface,
    ForceTorqueSensorInterface,
    GpsSensorInterface,
    ImuSensorHandle,
    ImuSensorInterface,
    MagneticFieldSensorInterface,
    RangeSensorInterface,
    ValuesSensorHandle,
)
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.parameters import Parameters
from station.core.toolbox.filters import FilterChain
from station.core.toolbox.publish_timer import PublishTimer

_UNKNOWN_COVARIANCE = [-1.0] + [0.0] * 8


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
_WRENCH_AXES = tuple(f"{kind}/{axis}" for kind in ("force", "torque") for axis in "xyz")


def _corrections(name: str, default: float, text: str) -> list[DeclaredParameter]:
    return [
        declare_number(
            f"{name}/{axis}",
            text,
            default,
            "" if name == "multiplier" else "N" if "force" in axis else "Nm",
        )
        for axis in _WRENCH_AXES
    ]


_OFFSET = _corrections("offset", 0.0, "is added to what is measured")
_MULTIPLIER = _corrections("multiplier", 1.0, "factor of what is measured and added")


class ForceTorqueSensorBroadcaster(Controller[ForceTorqueSensorInterface]):
    """Publishes one sensor in every cycle, and with filters the filtered values, too.

    The published value is `(measured + offset) * multiplier`. Commands nothing; a
    restart keeps what filters know.

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
    def update(self, time: float, period: float) -> None:
        measured = self._sensor.get_force() + self._sensor.get_torque()
        values = [
            (value + offset) * factor
            for value, offset, factor in zip(
                measured, self._offset, self._multiplier, strict=True
            )
        ]
        topics = {"wrench": values}
        if self._filters:
            topics["wrench_filtered"] = self._filters.update(values)
        self.messages = {
            name: WrenchStamped(time, self._frame, each[:3], each[3:])._asdict()
            for name, each in topics.items()
        }


class Imu(NamedTuple):
    """One measurement of an inertial measurement unit.

    A quantity that the unit does not measure is zero, and the first element of its
    covariance is -1. A covariance that is not known is zero.

    Attributes:
        stamp: Station time of the cycle [s].
        frame_id: Frame of the sensor.
        orientation: Quaternion x, y, z, w as in the message, shape (4,).
        orientation_covariance: Row-major [rad^2], shape (9,).
        angular_velocity: Angular velocity [rad/s], shape (3,).
        angular_velocity_covariance: Row-major [rad^2/s^2], shape (9,).
        linear_acceleration: Linear acceleration [m/s^2], shape (3,).
        linear_acceleration_covariance: Row-major [m^2/s^4], shape (9,).
    """

    stamp: float
    frame_id: str
    orientation: list[float]
    orientation_covariance: list[float]
    angular_velocity: list[float]
    angular_velocity_covariance: list[float]
    linear_acceleration: list[float]
    linear_acceleration_covariance: list[float]


class ImuSensorController(Controller[ImuSensorInterface]):
    """Publishes all inertial measurement units; commands nothing.

    Parameters: `publish_rate` [Hz], required; nothing is published when the rate is
    not positive.

    Attributes:
        readings: The last publication by sensor name, a new object each time; empty
            before the first. Any thread may read it.

    Source:
        ImuSensorController; differs: missed publications are not made up for in a
        burst, and a restart keeps the times of publication.
    """

    own_parameters = (PUBLISH_RATE,)

    @override
    def init(self, interface: ImuSensorInterface, params: Parameters) -> None:
        self.readings: dict[str, Imu] = {}
        self._timer = PublishTimer(PUBLISH_RATE.read_float(params))
        self._sensors = [interface.get_handle(name) for name in interface.get_names()]

    @override
    def starting(self, time: float) -> None:
        self._timer.start(time, at_once=False)

    @override
    def update(self, time: float, period: float) -> None:
        """Publish when a publication is due."""
        if self._timer.is_due(time):
            self.readings = {
                sensor.name: _reading(sensor, time) for sensor in self._sensors
            }

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        return {name: reading._asdict() for name, reading in self.readings.items()}


def _reading(sensor: ImuSensorHandle, time: float) -> Imu:
    turn, rate = sensor.get_orientation(), sensor.get_angular_velocity()
    acceleration = sensor.get_linear_acceleration()
    return Imu(
        time,
        sensor.get_frame_id(),
        *_measured(turn, sensor.get_orientation_covariance(), 4),
        *_measured(rate, sensor.get_angular_velocity_covariance(), 3),
        *_measured(acceleration, sensor.get_linear_acceleration_covariance(), 3),
    )


def _measured(
    values: list[float] | None, covariance: list[float] | None, size: int
) -> tuple[list[float], list[float]]:
    """Return values and covariance, marked as the message requires when unknown."""
    if covariance is None:
        covariance = list(_UNKNOWN_COVARIANCE) if values is None else [0.0] * 9
    return [0.0] * size if values is None else values, covariance


def _covariance(name: str) -> DeclaredParameter:
    return declare_numbers(
        name, "covariance, row-major about x, y, z", (0.0,) * 9, size=9
    )


class ValuesBroadcaster(Controller[HardwareResourceManager[ValuesSensorHandle]]):
    """Publishes one sensor in every cycle; commands nothing.

    Attributes:
        topic: Name of the publication.
        fields: By field of the message, the name of its value, or the names of a
            vector.
        constants: By field that does not change, the parameter that gives its value.
    """

    topic: ClassVar[str]
    fields: ClassVar[Mapping[str, str | tuple[str, ...]]]
    constants: ClassVar[Mapping[str, DeclaredParameter]]
    own_parameters: ClassVar[tuple[DeclaredParameter, ...]] = (SENSOR_NAME, FRAME_ID)

    @override
    def init(
        self, interface: HardwareResourceManager[ValuesSensorHandle], params: Parameters
    ) -> None:
        self._sensor = interface.get_handle(SENSOR_NAME.read_str(params))
        self._fixed: dict[str, object] = {
            "frame_id": FRAME_ID.read_str(params) or self._sensor.get_frame_id()
        }
        for field, declared in self.constants.items():
            is_list = declared.type is ParameterType.NUMBERS
            read = declared.read_float_list if is_list else declared.read_float
            self._fixed[field] = read(params)

    @override
    def update(self, time: float, period: float) -> None:
        values = self._sensor.get_values()
        measured = {
            field: values[names]
            if isinstance(names, str)
            else [values[name] for name in names]
            for field, names in self.fields.items()
        }
        self.messages = {self.topic: {"stamp": time, **self._fixed, **measured}}


class RangeSensorBroadcaster(ValuesBroadcaster):
    """Publishes the distance that a range sensor measures, as sensor_msgs/Range."""

    hardware_interface: ClassVar[type] = RangeSensorInterface
    topic = "range"
    fields: ClassVar = {"range": "range"}
    constants: ClassVar = {
        "radiation_type": declare_number(
            "radiation_type", "0: sound, 1: infrared", 0.0
        ),
        "field_of_view": declare_number(
            "field_of_view", "size of the arc", 0.52, "rad"
        ),
        "min_range": declare_number("min_range", "smallest distance", 0.52, "m"),
        "max_range": declare_number("max_range", "largest distance", 4.0, "m"),
        "variance": declare_number("variance", "variance of the distance", 0.0, "m^2"),
    }
    own_parameters = (*constants.values(),)

    @override
    def init(
        self, interface: HardwareResourceManager[ValuesSensorHandle], params: Parameters
    ) -> None:
        super().init(interface, params)
        # The message has a whole number.
        kind = self.constants["radiation_type"].read_float(params)
        self._fixed["radiation_type"] = int(kind)


class MagnetometerBroadcaster(ValuesBroadcaster):
    """Publishes the readings of a magnetometer, as sensor_msgs/MagneticField."""

    hardware_interface: ClassVar[type] = MagneticFieldSensorInterface
    topic = "magnetic_field"
    fields: ClassVar = {
        "magnetic_field": tuple(f"magnetic_field.{axis}" for axis in "xyz")
    }
    constants: ClassVar = {
        "magnetic_field_covariance": _covariance("static_covariance")
    }
    own_parameters = (*constants.values(),)


_COVARIANCES = tuple(
    f"{each}_covariance" for each in ("latitude", "longitude", "altitude")
)
_READS_COVARIANCE = declare_boolean(
    "read_covariance_from_interface",
    "whether the sensor measures the covariance",
    default=False,
)
_DIAGONAL_KNOWN, _KNOWN = 2, 3
"""Numbers of sensor_msgs/NavSatFix."""


class GPSSensorBroadcaster(ValuesBroadcaster):
    """Publishes the place of a satellite receiver, as sensor_msgs/NavSatFix."""

    hardware_interface: ClassVar[type] = GpsSensorInterface
    topic = "gps/fix"
    fields: ClassVar = {each: each for each in ("latitude", "longitude", "altitude")}
    constants: ClassVar = {
        "position_covariance": _covariance("static_position_covariance")
    }
    own_parameters = (*constants.values(), _READS_COVARIANCE)

    @override
    def init(
        self, interface: HardwareResourceManager[ValuesSensorHandle], params: Parameters
    ) -> None:
        super().init(interface, params)
        self._reads_covariance = _READS_COVARIANCE.read_bool(params)
        self._fixed["position_covariance_type"] = _KNOWN
        if self._reads_covariance:
            self._fixed["position_covariance_type"] = _DIAGONAL_KNOWN
            for name in _COVARIANCES:
                _require(self._sensor, name)

    @override
    def update(self, time: float, period: float) -> None:
        super().update(time, period)
        values, message = self._sensor.get_values(), {**self.messages[self.topic]}
        message["status"] = {key: int(values[key]) for key in ("status", "service")}
        if self._reads_covariance:
            diagonal = [0.0] * 9
            diagonal[::4] = [values[name] for name in _COVARIANCES]
            message["position_covariance"] = diagonal
        self.messages = {self.topic: message}


_BATTERIES = declare_strings("batteries", "the batteries")
_BATTERY_MEANS = ("temperature", "current", "percentage")
"""Of several batteries the means are published; charges and capacities are added."""
_BATTERY_FLAGS = (
    *_BATTERY_MEANS,
    "charge",
    "power_supply_status",
    "power_supply_health",
    "present",
)
_BATTERY_INTERFACES = tuple(f"battery_{key}" for key in _BATTERY_FLAGS)
_BATTERY_PROPERTIES = (
    "capacity",
    "design_capacity",
    "minimum_voltage",
    "maximum_voltage",
)
_BATTERY_MORE = ("power_supply_technology", "location", "serial_number")


class BatteryStateBroadcaster(Controller[BatterySensorInterface]):
    """Publishes each battery, and all as one, as sensor_msgs/BatteryState.

    A mean or a sum is NaN if one of its values is; a value that a battery does not
    measure is not one of them.

    Source:
        BatteryStateBroadcaster; differs: the older parameter `sensor_name` is refused,
        and the values of `interfaces` must be values that the battery has.
    """

    own_parameters = (_BATTERIES,)

    @override
    def init(self, interface: BatterySensorInterface, params: Parameters) -> None:
        names = _BATTERIES.read_str_list(params)
        if not names or len(set(names)) != len(names):
            _BATTERIES.refuse(params, names, "names, each once")
        # Their keys are checked below, because their names are those of batteries.
        accepted = ("interfaces", *names)
        self.accepted_parameters = accepted  # type: ignore[misc]  # of this one alone
        self._batteries = [
            _Battery(
                interface.get_handle(name),
                _mapping(params, f"interfaces/{name}", _BATTERY_INTERFACES),
                _mapping(params, name, (*_BATTERY_PROPERTIES, *_BATTERY_MORE)),
            )
            for name in names
        ]

    @override
    def update(self, time: float, period: float) -> None:
        each = [battery.message(time) for battery in self._batteries]
        whole: dict[str, Any] = {**each[0], "frame_id": ""}
        whole["voltage"] = sum(one["voltage"] for one in each) / len(each)
        for key in (*_BATTERY_MEANS, "charge"):
            known = [
                one[key]
                for one, battery in zip(each, self._batteries, strict=True)
                if battery.tells(key)
            ]
            whole[key] = sum(known) if known else nan
            if known and key in _BATTERY_MEANS:
                whole[key] /= len(known)
        for key in ("capacity", "design_capacity"):
            whole[key] = sum(one[key] for one in each)
        for key in ("power_supply_status", "power_supply_health"):
            whole[key] = max(one[key] for one in each)
        whole["present"] = True
        kinds = {one["power_supply_technology"] for one in each}
        whole["power_supply_technology"] = kinds.pop() if len(kinds) == 1 else 0
        for key in ("location", "serial_number"):
            whole[key] = "".join(f"{one[key]}, " for one in each)
        raw = {"stamp": time, "battery_states": each}
        self.messages = {"battery_state": whole, "raw_battery_states": raw}


class _Battery:
    """One battery: measured values, and those of its parameters."""

    def __init__(
        self,
        sensor: ValuesSensorHandle,
        flags: Mapping[str, object],
        own: Mapping[str, object],
    ) -> None:
        self._sensor = sensor
        self._measured = [
            key for key in _BATTERY_FLAGS if flags.get(f"battery_{key}") is True
        ]
        for key in self._measured:
            _require(sensor, f"battery_{key}")
        # A property that nobody knows may be written as NaN.
        numbers = {
            key: float(value) if isinstance(value := own.get(key), int | float) else nan
            for key in _BATTERY_PROPERTIES
        }
        self._low = numbers.pop("minimum_voltage")
        self._high = numbers.pop("maximum_voltage")
        if self._low >= self._high:
            raise ParameterError(
                f"Battery '{sensor.name}' has a maximum_voltage of {self._high:g} V; "
                f"it must be above the minimum of {self._low:g} V.",
                remedy="Correct one of the two.",
                details={"parameter": f"{sensor.name}/maximum_voltage"},
            )
        self._fixed: dict[str, Any] = {
            "frame_id": sensor.name,
            **dict.fromkeys(("temperature", "current", "charge", "percentage"), nan),
            "power_supply_status": 0,
            "power_supply_health": 0,
            **numbers,
            "power_supply_technology": own.get("power_supply_technology", 0),
            "location": str(own.get("location", "")),
            "serial_number": str(own.get("serial_number", "")),
        }

    def tells(self, key: str) -> bool:
        """Return whether the battery measures `key`, or the voltage tells it."""
        by_voltage = key == "percentage" and isfinite(self._high - self._low)
        return key in self._measured or by_voltage

    def message(self, time: float) -> dict[str, Any]:
        """Return the state of the battery; NaN for unknown values.

        Args:
            time: Station time [s].
        """
        values = self._sensor.get_values()
        voltage = values["battery_voltage"]
        found = {**self._fixed, "stamp": time, "voltage": voltage}
        # Without a measurement the voltage tells both.
        found["present"] = isfinite(voltage) and voltage != 0.0
        found["percentage"] = 100.0 * (voltage - self._low) / (self._high - self._low)
        for key in self._measured:
            found[key] = values[f"battery_{key}"]
        for key in ("power_supply_status", "power_supply_health"):
            found[key] = int(found[key])
        found["present"] = bool(found["present"])
        return found


def _mapping(
    params: Parameters, key: str, known: Sequence[str]
) -> Mapping[str, object]:
    """Return the parameters of a battery.

    Raises:
        ParameterError: The parameter is not a mapping, or has an unknown key.
    """
    place = params.resolve(key)
    value = params.tree.get(place, {})
    unknown = sorted(set(value) - set(known)) if isinstance(value, dict) else [""]
    if not isinstance(value, dict) or unknown:
        raise ParameterError(
            f"Parameter '{place}' has the unknown key '{unknown[0]}'. "
            f"{suggest(unknown[0], known)}",
            remedy=f"Known are {', '.join(known)}.",
            details={"parameter": place},
        )
    return value


def _require(sensor: ValuesSensorHandle, value: str) -> None:
    if not sensor.has(value):
        raise ResourceNotFoundError(
            f"Sensor '{sensor.name}' has no value '{value}'.",
            remedy="Leave the parameter out that asks for it.",
            details={"resource": f"{sensor.name}/{value}"},
        )
