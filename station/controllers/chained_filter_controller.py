"""Filter states, and export the filtered values for other controllers.

Source: ros2_controllers@6.x chained_filter_controller/src/chained_filter.cpp. The names
of states are those of ROS 2, e.g. `joint1/position`: ros2_control@6.x
hardware_interface/doc/hardware_interface_types_userdoc.rst.
"""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import ClassVar

from typing_extensions import override

from station.core.control.chainable_controller import (
    ChainableController,
    ExportedState,
    ExportedStateInterface,
)
from station.core.declared_parameter import declare_mappings, declare_strings
from station.core.errors import ControllerLoadError, ResourceNotFoundError, suggest
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
    GpioStateInterface,
    ImuSensorInterface,
    JointStateInterface,
    ValuesSensorHandle,
)
from station.core.hardware.interfaces.sensors import SEMANTIC_INTERFACES
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.toolbox.filters import FilterChain
from station.memory.doubles import zeros

_INPUTS = declare_strings(
    "input_interfaces", "the states that are filtered, e.g. `joint1/position`"
)
_OUTPUTS = declare_strings(
    "output_interfaces", "names of the exported states, one for each input"
)
_CHAIN = declare_mappings(
    "filter_chain",
    "filters of all inputs; else `<input>/filter_chain`",
    default_text="that of each input",
)
Read = Callable[[], float]
_NAN = float("nan")


class ChainedFilter(ChainableController):
    """Exports filtered states; commands nothing. A restart keeps what filters know.

    Source:
        ChainedFilter; differs: before the first update an output is 0 and not NaN, and
        a filter that is missing is refused.
    """

    optional_interfaces: ClassVar[tuple[type, ...]] = (
        JointStateInterface,
        ForceTorqueSensorInterface,
        ImuSensorInterface,
        GpioStateInterface,
        *SEMANTIC_INTERFACES.values(),
    )
    own_parameters = (_INPUTS, _OUTPUTS, _CHAIN)

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        inputs = _INPUTS.read_str_list(params)
        self._outputs = _OUTPUTS.read_str_list(params)
        if not inputs:
            _INPUTS.refuse(params, inputs, "at least one state")
        if len(self._outputs) != len(inputs) or len({*self._outputs}) != len(inputs):
            _OUTPUTS.refuse(params, self._outputs, "one name for each input")
        self._read = [find_state(hw, name) for name in inputs]
        common = params.has(_CHAIN.name)
        keys = [_CHAIN.name if common else f"{n}/{_CHAIN.name}" for n in inputs]
        for key in keys:
            if not params.has(key):
                raise ControllerLoadError(
                    f"There is no filter chain '{params.resolve(key)}'.",
                    remedy=f"Give '{_CHAIN.name}' for all inputs, or one for each.",
                    details={"parameter": params.resolve(key)},
                )
        # Each input has filters of its own: one may stand still while others go on.
        self._chains = [
            FilterChain.read(params.get(key), params.resolve(key)) for key in keys
        ]
        self._filtered = zeros(len(inputs))

    @override
    def on_export_state_interfaces(self) -> Sequence[ExportedState]:
        return [
            ExportedState(name, self._filtered, index)
            for index, name in enumerate(self._outputs)
        ]

    @override
    def update_and_write_commands(self, time: float, period: float) -> None:
        for index, (read, chain) in enumerate(
            zip(self._read, self._chains, strict=True)
        ):
            value = read()
            # A sensor without a reading leaves its output as it was.
            if isfinite(value):
                self._filtered[index] = chain.update([value])[0]


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
