"""Find states for a controller by their names in ROS 2, e.g. `joint1/position`.

Source: ros2_control@6.x hardware_interface/doc/hardware_interface_types_userdoc.rst.
"""

from collections.abc import Callable

from station.core.control.chainable_controller import ExportedStateInterface
from station.core.errors import ResourceNotFoundError, suggest
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
    GpioStateInterface,
    ImuSensorInterface,
    JointStateInterface,
    ValuesSensorHandle,
)
from station.core.hardware.interfaces.semantic import SEMANTIC_INTERFACES
from station.core.hardware.robot_hw import RobotHW

Read = Callable[[], float]
_NAN = float("nan")


def find_state(hw: RobotHW, name: str) -> Read:
    """Return a function that reads a state of the robot or of another controller.

    Args:
        hw: The robot, as passed to the controller's `init`.
        name: `<joint>/position`, `…/velocity`, `…/effort`; `<sensor>/force.x`,
            `…/angular_velocity.z` and so on; `<gpio>/<interface>`; or the full name of
            a state that another controller exports.

    Raises:
        ResourceNotFoundError: There is no such state.
    """
    found = {**_of_joints(hw), **_of_sensors(hw), **_single(hw)}
    if name not in found:
        raise ResourceNotFoundError(
            f"There is no state interface '{name}'.",
            remedy=suggest(name, found),
            details={"resource": name},
        )
    # The claim of an exported state names its reader.
    exported = hw.get(ExportedStateInterface)
    if exported is not None and name in exported.get_names():
        return exported.get_handle(name).get_value
    return found[name]


def _of_joints(hw: RobotHW) -> dict[str, Read]:
    joints = hw.get(JointStateInterface)
    found: dict[str, Read] = {}
    for handle in () if joints is None else joints.handles():
        found[f"{handle.name}/position"] = handle.get_position
        found[f"{handle.name}/velocity"] = handle.get_velocity
        found[f"{handle.name}/effort"] = handle.get_effort
    return found


def _of_sensors(hw: RobotHW) -> dict[str, Read]:
    found: dict[str, Read] = {}

    def add(name: str, vector: Callable[[], list[float] | None], axes: str) -> None:
        for index, axis in enumerate(axes):
            found[f"{name}.{axis}"] = _part(vector, index)

    wrenches = hw.get(ForceTorqueSensorInterface)
    for wrench in () if wrenches is None else wrenches.handles():
        add(f"{wrench.name}/force", wrench.get_force, "xyz")
        add(f"{wrench.name}/torque", wrench.get_torque, "xyz")
    imus = hw.get(ImuSensorInterface)
    for imu in () if imus is None else imus.handles():
        add(f"{imu.name}/orientation", imu.get_orientation, "xyzw")
        add(f"{imu.name}/angular_velocity", imu.get_angular_velocity, "xyz")
        add(f"{imu.name}/linear_acceleration", imu.get_linear_acceleration, "xyz")
    for kind in SEMANTIC_INTERFACES.values():
        sensors = hw.get(kind)
        for sensor in () if sensors is None else sensors.handles():
            for value in sensor.get_values():
                found[f"{sensor.name}/{value}"] = _named(sensor, value)
    return found


def _single(hw: RobotHW) -> dict[str, Read]:
    found: dict[str, Read] = {}
    gpios, exported = hw.get(GpioStateInterface), hw.get(ExportedStateInterface)
    for gpio in () if gpios is None else gpios.handles():
        found[gpio.name] = gpio.get_value
    for state in () if exported is None else exported.handles():
        found[state.name] = state.get_value
    return found


def _named(sensor: ValuesSensorHandle, value: str) -> Read:
    return lambda: sensor.get_values()[value]


def _part(vector: Callable[[], list[float] | None], index: int) -> Read:
    def read() -> float:
        values = vector()
        return _NAN if values is None else values[index]

    return read
