"""Sensors on links of a simulated robot.

A force-torque sensor is between its link and the parent link. It measures the force and
the torque with which the parent holds the link, in the link's frame: at rest the weight
of the link and of all links behind it, upwards. An inertial measurement unit at rest
measures 9.81 m/s^2 upwards; its orientation is that of the link in the world. A range
sensor measures along the x axis of its link, and reads infinity if it meets nothing.
The magnetic field of the world has x to the east and y to the north. A receiver of
satellite navigation and a battery keep their configured values.
"""

from collections.abc import Mapping, Sequence
from math import inf, sqrt

import mujoco

from station.core.description.urdf import Pose
from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
    ImuSensorHandle,
    ImuSensorInterface,
    ValuesSensorHandle,
)
from station.core.hardware.interfaces.sensors import (
    SEMANTIC_INTERFACES,
    SEMANTIC_VALUES,
)
from station.hw.mujoco.mujoco_robot_parameters import SensorRequest, SensorType

_KINDS: Mapping[SensorType, tuple[str, ...]] = {
    SensorType.FORCE_TORQUE: ("force", "torque"),
    SensorType.IMU: ("framequat", "gyro", "accelerometer"),
    SensorType.RANGE: ("rangefinder",),
    SensorType.MAGNETOMETER: ("magnetometer",),
}
_MUJOCO_TYPES = {
    "force": mujoco.mjtSensor.mjSENS_FORCE,
    "torque": mujoco.mjtSensor.mjSENS_TORQUE,
    "framequat": mujoco.mjtSensor.mjSENS_FRAMEQUAT,
    "gyro": mujoco.mjtSensor.mjSENS_GYRO,
    "accelerometer": mujoco.mjtSensor.mjSENS_ACCELEROMETER,
    "rangefinder": mujoco.mjtSensor.mjSENS_RANGEFINDER,
    "magnetometer": mujoco.mjtSensor.mjSENS_MAGNETOMETER,
}
_DISTANCE = 1
"""A range finder's data: only the distance. Source: MuJoCo, mjtRayDataField."""
_ALONG_X = Pose(quaternion=(sqrt(0.5), 0.0, sqrt(0.5), 0.0))
"""Turns the z axis, along which MuJoCo measures a range, into the x axis."""


def add_sensors(
    spec: mujoco.MjSpec,
    requests: tuple[SensorRequest, ...],
    magnetic_field: Sequence[float],
) -> None:
    """Add sensors to a robot in the world.

    Args:
        spec: The world; changed.
        requests: The sensors.
        magnetic_field: Field of the world, eastwards, northwards and upwards [T],
            shape (3,).

    Raises:
        ParameterError: A link is not in the world.
    """
    for request in requests:
        if request.type.is_constant:
            continue
        site = _site_of(spec, request)
        if request.type is SensorType.MAGNETOMETER:
            spec.option.magnetic = magnetic_field
        if request.type is SensorType.RANGE:
            site = _add_beam(spec, site, request)
        for kind in _KINDS[request.type]:
            sensor = spec.add_sensor(
                name=f"{request.name}/{kind}",
                type=_MUJOCO_TYPES[kind],
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=site,
            )
            if kind == "rangefinder":
                sensor.intprm[0] = _DISTANCE


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
        self._named = {kind: make() for kind, make in SEMANTIC_INTERFACES.items()}
        self._readings: list[tuple[slice, list[float]]] = []
        self._quaternions: list[tuple[int, list[float]]] = []
        self._ranges: list[tuple[int, float, list[float]]] = []
        for request in requests:
            if request.type is SensorType.FORCE_TORQUE:
                self._add_force_torque(model, request)
            elif request.type is SensorType.IMU:
                self._add_imu(model, request)
            else:
                self._add_named(model, request)

    def interfaces(self) -> list[object]:
        """Return the interfaces that have at least one sensor."""
        named = [one for one in self._named.values() if one.get_names()]
        both = (self._force_torque, self._imu)
        return [*(one for one in both if one.get_names()), *named]

    def read(self) -> None:
        """Bring the handles' lists up to date. Control thread."""
        values: list[float] = self._data.tolist()
        for where, storage in self._readings:
            storage[:] = values[where]
        for start, storage in self._quaternions:
            w, x, y, z = values[start : start + 4]
            storage[:] = [x, y, z, w]
        for start, most, storage in self._ranges:
            # MuJoCo returns -1 for a ray that meets nothing.
            distance = values[start]
            storage[0] = distance if 0.0 <= distance <= most else inf

    def _add_named(self, model: mujoco.MjModel, request: SensorRequest) -> None:
        names = SEMANTIC_VALUES[request.type.value]
        if request.type.is_constant:
            names = tuple(dict.fromkeys((*names, *request.values)))
        storage = [request.values.get(name, 0.0) for name in names]
        for kind in _KINDS.get(request.type, ()):
            where = _slice(model, f"{request.name}/{kind}")
            if request.type is SensorType.RANGE:
                self._ranges.append((where.start, request.max_range, storage))
            else:
                self._readings.append((where, storage))
        self._named[request.type.value].register_handle(
            ValuesSensorHandle(request.name, request.link, storage, names)
        )

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
    if spec.site(request.link) is not None:  # a link that is only a frame
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


def _add_beam(spec: mujoco.MjSpec, site: str, request: SensorRequest) -> str:
    """Add a site whose z axis is the x axis of another site; return its name."""
    found = spec.site(site)
    w, x, y, z = (float(each) for each in found.quat)
    turned = Pose(quaternion=(w, x, y, z)).compose(_ALONG_X)
    name = f"{request.name}/beam"
    found.parent.add_site(name=name, pos=found.pos, quat=turned.quaternion)
    return name


def _slice(model: mujoco.MjModel, name: str) -> slice:
    sensor = model.sensor(name)
    start = int(sensor.adr[0])
    return slice(start, start + int(sensor.dim[0]))
