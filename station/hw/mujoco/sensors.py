"""Force-torque sensors and inertial measurement units on links of a simulated robot.

A force-torque sensor is between its link and the parent link. It measures the force and
the torque with which the parent holds the link, in the link's frame: at rest the weight
of the link and of all links behind it, upwards. An inertial measurement unit at rest
measures 9.81 m/s^2 upwards; its orientation is that of the link in the world.
"""

import mujoco

from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
    ImuSensorHandle,
    ImuSensorInterface,
)
from station.hw.mujoco.mujoco_robot_parameters import SensorRequest, SensorType

_KINDS = {
    SensorType.FORCE_TORQUE: ("force", "torque"),
    SensorType.IMU: ("framequat", "gyro", "accelerometer"),
}
_MUJOCO_TYPES = {
    "force": mujoco.mjtSensor.mjSENS_FORCE,
    "torque": mujoco.mjtSensor.mjSENS_TORQUE,
    "framequat": mujoco.mjtSensor.mjSENS_FRAMEQUAT,
    "gyro": mujoco.mjtSensor.mjSENS_GYRO,
    "accelerometer": mujoco.mjtSensor.mjSENS_ACCELEROMETER,
}


def add_sensors(spec: mujoco.MjSpec, requests: tuple[SensorRequest, ...]) -> None:
    """Add sensors to a robot in the world.

    Args:
        spec: The world; changed.
        requests: The sensors.

    Raises:
        ParameterError: A link is not in the world.
    """
    for request in requests:
        site = _site_of(spec, request)
        for kind in _KINDS[request.type]:
            spec.add_sensor(
                name=f"{request.name}/{kind}",
                type=_MUJOCO_TYPES[kind],
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=site,
            )


class WorldSensors:
    """Copies the readings of sensors into the lists that the handles read.

    Args:
        model: The world's model, made with `add_sensors`.
        data: The world's data.
        requests: The sensors.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        requests: tuple[SensorRequest, ...],
    ) -> None:
        self._data = data.sensordata
        self._force_torque = ForceTorqueSensorInterface()
        self._imu = ImuSensorInterface()
        self._readings: list[tuple[slice, list[float]]] = []
        self._quaternions: list[tuple[int, list[float]]] = []
        for request in requests:
            if request.type is SensorType.FORCE_TORQUE:
                self._add_force_torque(model, request)
            else:
                self._add_imu(model, request)

    def interfaces(self) -> list[ForceTorqueSensorInterface | ImuSensorInterface]:
        """Return the interfaces that have at least one sensor."""
        return [i for i in (self._force_torque, self._imu) if i.get_names()]

    def read(self) -> None:
        """Bring the handles' lists up to date. Control thread."""
        values: list[float] = self._data.tolist()
        for where, storage in self._readings:
            storage[:] = values[where]
        for start, storage in self._quaternions:
            w, x, y, z = values[start : start + 4]
            storage[:] = [x, y, z, w]

    def _add_force_torque(self, model: mujoco.MjModel, request: SensorRequest) -> None:
        force, torque = [0.0] * 3, [0.0] * 3
        self._readings.append((_slice(model, f"{request.name}/force"), force))
        self._readings.append((_slice(model, f"{request.name}/torque"), torque))
        self._force_torque.register_handle(
            ForceTorqueSensorHandle(
                request.name, request.link, force, torque, is_reaction=True
            )
        )

    def _add_imu(self, model: mujoco.MjModel, request: SensorRequest) -> None:
        orientation, rate, acceleration = [0.0, 0.0, 0.0, 1.0], [0.0] * 3, [0.0] * 3
        start = _slice(model, f"{request.name}/framequat").start
        self._quaternions.append((start, orientation))
        self._readings.append((_slice(model, f"{request.name}/gyro"), rate))
        self._readings.append((
            _slice(model, f"{request.name}/accelerometer"),
            acceleration,
        ))
        self._imu.register_handle(
            ImuSensorHandle(
                request.name,
                request.link,
                orientation=orientation,
                angular_velocity=rate,
                linear_acceleration=acceleration,
            )
        )


def _site_of(spec: mujoco.MjSpec, request: SensorRequest) -> str:
    """Return the name of a site in the link's frame; add the site if necessary.

    Raises:
        ParameterError: The robot has no such link.
    """
    if spec.site(request.link) is not None:  # a link that is nothing but a frame
        return request.link
    body = spec.body(request.link)
    if body is None:
        links = [b.name for b in spec.bodies if b.name != "world"]
        links += [site.name for site in spec.sites]
        raise ParameterError(
            f"Sensor '{request.name}' is on the link '{request.link}', which the robot "
            "does not have.",
            remedy=f"Its links are {', '.join(links)}.",
            details={"sensor": request.name},
        )
    body.add_site(name=request.link)
    return request.link


def _slice(model: mujoco.MjModel, name: str) -> slice:
    sensor = model.sensor(name)
    start = int(sensor.adr[0])
    return slice(start, start + int(sensor.dim[0]))
