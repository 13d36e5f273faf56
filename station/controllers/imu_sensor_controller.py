"""Publish the readings of inertial measurement units at a fixed rate.

Source: ros_controllers@678b92a imu_sensor_controller/src/imu_sensor_controller.cpp;
sensor_msgs/Imu.msg.
"""

from collections.abc import Mapping
from typing import NamedTuple

from typing_extensions import override

from station.core.control.controller import PUBLISH_RATE, Controller
from station.core.hardware.interfaces import ImuSensorHandle, ImuSensorInterface
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

_UNKNOWN = [-1.0] + [0.0] * 8


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
        covariance = list(_UNKNOWN) if values is None else [0.0] * 9
    return [0.0] * size if values is None else values, covariance
