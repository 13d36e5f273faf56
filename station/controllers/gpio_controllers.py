"""Command and publish general-purpose inputs and outputs.

Source: ros2_controllers@6.x gpio_controllers/src/gpio_command_controller.cpp.
"""

from typing import ClassVar, TypeVar

from typing_extensions import override

from station.core.control.controller import MultiInterfaceController
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_mappings,
    declare_strings,
)
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    GpioCommandInterface,
    GpioStateHandle,
    GpioStateInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)

_GPIOS = declare_strings("gpios", "names of the inputs and outputs")
_COMMANDS = declare_mappings(
    "command_interfaces", "`<gpio>/interfaces`: what is commanded", default_text="none"
)
_STATES = declare_mappings(
    "state_interfaces",
    "`<gpio>/interfaces`: what is published",
    default_text="all of the gpios",
)


class GpioCommandController(MultiInterfaceController):
    """Commands outputs by set-points, and publishes `gpio_states` in every cycle.

    Without `command_interfaces` it only publishes. A start, and a set-point that
    expires, keep the values that the outputs have.

    Source:
        GpioCommandController; differs: set-points come from the port of the controller,
        one number for each commanded interface in the order of the parameters.
    """

    optional_interfaces: ClassVar[tuple[type, ...]] = (
        GpioCommandInterface,
        GpioStateInterface,
    )
    own_parameters = (_GPIOS, _COMMANDS, _STATES, *timeout_parameters())

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        gpios = _GPIOS.read_str_list(params)
        if len(set(gpios)) != len(gpios):
            _GPIOS.refuse(params, gpios, "names of gpios, each once")
        states, commands = hw.get(GpioStateInterface), hw.get(GpioCommandInterface)
        commanded = _names(params, _COMMANDS, gpios)
        published = _names(params, _STATES, gpios)
        if not published and states is not None:
            published = [n for n in states.get_names() if n.partition("/")[0] in gpios]
        if not commanded and not published:
            _GPIOS.refuse(params, gpios, "names of gpios that the robot has")
        self._outputs = [_of(commands, hw).get_handle(n) for n in commanded]
        handles = [_of(states, hw).get_handle(name) for name in published]
        self._groups: dict[str, list[GpioStateHandle]] = {gpio: [] for gpio in gpios}
        for handle in handles:
            self._groups[handle.name.partition("/")[0]].append(handle)
        if not commanded:
            return
        timeout, action = read_command_timeout(params)
        elements = [SetPointElement(name, "") for name in commanded]
        self.set_points = SetPointPort(elements, timeout=timeout)
        self._active = ActiveSetPoint(
            self.set_points, action, ", ".join(commanded), self._present
        )

    @override
    def starting(self, time: float) -> None:
        if self._outputs:
            self._active.start_at_rest()

    @override
    def update(self, time: float, period: float) -> None:
        if self._outputs:
            wanted = self._active.newest()
            for output, value in zip(self._outputs, wanted, strict=True):
                output.set_command(value)
        values = [
            {
                "interface_names": [h.name.partition("/")[2] for h in handles],
                "values": [handle.get_value() for handle in handles],
            }
            for handles in self._groups.values()
        ]
        self.messages = {
            "gpio_states": {
                "stamp": time,
                "interface_groups": [*self._groups],
                "interface_values": values,
            }
        }

    def _present(self) -> list[float]:
        return [output.present() for output in self._outputs]


_InterfaceT = TypeVar("_InterfaceT")


def _of(interface: _InterfaceT | None, hw: RobotHW) -> _InterfaceT:
    if interface is None:
        raise ControllerLoadError(
            "The robot has no such inputs or outputs.",
            remedy=f"It offers: {', '.join(hw.get_names()) or 'none'}.",
        )
    return interface


def _names(
    params: Parameters, declared: DeclaredParameter, gpios: list[str]
) -> list[str]:
    """Return `<gpio>/<interface>` of each interface that a parameter lists."""
    value = params.get(declared.name)
    if value is None:
        return []
    found: list[str] = []
    for gpio, entry in value.items() if isinstance(value, dict) else [("", None)]:
        # The documentation of the original writes a list with one mapping in it.
        parts = entry if isinstance(entry, list) else [entry]
        names = [
            each
            for part in parts
            for each in (
                part.get("interfaces") or () if isinstance(part, dict) else [0]
            )
        ]
        known = gpio in gpios and all(isinstance(name, str) for name in names)
        if not known or len(set(names)) != len(names):
            declared.refuse(
                params, value, "`interfaces` for each of the gpios, each once"
            )
        found += [f"{gpio}/{name}" for name in names]
    return found
