"""Filter states, and export the filtered values for other controllers.

Source: ros2_controllers@6.x chained_filter_controller/src/chained_filter.cpp.
"""

from collections.abc import Sequence
from math import isfinite
from typing import ClassVar

from typing_extensions import override

from station.core.control.chainable_controller import ChainableController, ExportedState
from station.core.declared_parameter import declare_mappings, declare_strings
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
    GpioStateInterface,
    ImuSensorInterface,
    JointStateInterface,
)
from station.core.hardware.interfaces.semantic import SEMANTIC_INTERFACES
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.toolbox.filters import FilterChain
from station.core.toolbox.state_interfaces import find_state
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


class ChainedFilter(ChainableController):
    """Exports filtered states; commands nothing.

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
    def starting(self, time: float) -> None:
        for chain in self._chains:
            chain.reset()

    @override
    def update_and_write_commands(self, time: float, period: float) -> None:
        for index, (read, chain) in enumerate(
            zip(self._read, self._chains, strict=True)
        ):
            value = read()
            # A sensor without a reading leaves its output as it was.
            if isfinite(value):
                self._filtered[index] = chain.update([value])[0]
