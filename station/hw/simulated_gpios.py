"""General-purpose inputs and outputs without hardware: outputs take their commands.

```yaml
gpios:
  flange:
    command_interfaces: [vacuum]
    state_interfaces: [vacuum, pressure]
    initial_values: {pressure: 1.0}
```

Source: ros2_control@6.x mock_components/GenericSystem; differs: `min` and `max` apply.
"""

from collections.abc import Sequence
from math import inf

from station.core.description.ros2_control import ComponentTag, InterfaceTag
from station.core.errors import ParameterError, suggest
from station.core.hardware.interfaces.sensors import (
    GpioCommandHandle,
    GpioCommandInterface,
    GpioStateHandle,
    GpioStateInterface,
)
from station.core.parameters import Parameters
from station.memory.doubles import doubles

_KEYS = ("command_interfaces", "state_interfaces", "initial_values")


def read_gpios(params: Parameters) -> tuple[ComponentTag, ...]:
    """Return the inputs and outputs in the parameter `gpios` of a robot.

    Args:
        params: The robot's namespace.

    Raises:
        ParameterError: A key is unknown, or a value is impossible.
    """
    found = []
    gpios = params.namespace("gpios")
    for name in gpios.keys():  # noqa: SIM118 - no mapping
        entry = gpios.namespace(name)
        for key in set(entry.keys()) - set(_KEYS):
            raise ParameterError(
                f"Parameter '{entry.resolve(key)}' is unknown. {suggest(key, _KEYS)}",
                remedy=f"Known are {', '.join(_KEYS)}.",
                details={"parameter": entry.resolve(key)},
            )
        initial = entry.namespace("initial_values")
        commands, states = (
            tuple(
                InterfaceTag(each, initial_value=initial.get_float(each, 0.0))
                for each in entry.get_str_list(key, [])
            )
            for key in _KEYS[:2]
        )
        found.append(ComponentTag(name, commands, states))
    return tuple(found)


class SimulatedGpios:
    """Inputs keep their initial values; outputs have their last command.

    Args:
        tags: The inputs and outputs.

    Attributes:
        names: Name of each value, `<gpio>/<interface>`, in the order of `states`.
        states: Present value of each input and output; tests may set inputs.
    """

    def __init__(self, tags: Sequence[ComponentTag]) -> None:
        slots: dict[str, float] = {}
        outputs: dict[str, InterfaceTag] = {}
        for tag in tags:
            for one in (*tag.commands, *tag.states):
                name = f"{tag.name}/{one.name}"
                slots[name] = one.initial_value or slots.get(name, 0.0)
            outputs |= {f"{tag.name}/{one.name}": one for one in tag.commands}
        self.names = list(slots)
        self._initial = list(slots.values())
        self.states = doubles(self._initial)
        self._commands = doubles(self._initial)
        self._outputs: list[tuple[int, float, float]] = []
        self._state_interface = GpioStateInterface()
        self._command_interface = GpioCommandInterface()
        readable = {f"{tag.name}/{one.name}" for tag in tags for one in tag.states}
        for index, name in enumerate(self.names):
            if name in readable:
                self._state_interface.register_handle(
                    GpioStateHandle(name, self.states, index)
                )
            if name in outputs:
                one = outputs[name]
                low, high = (0.0, 1.0) if one.data_type == "bool" else (-inf, inf)
                low = low if one.minimum is None else one.minimum
                high = high if one.maximum is None else one.maximum
                self._outputs.append((index, low, high))
                self._command_interface.register_handle(
                    GpioCommandHandle(name, self._commands, self.states, index)
                )

    def interfaces(self) -> list[GpioStateInterface | GpioCommandInterface]:
        """Return the interfaces that have at least one handle."""
        both = (self._state_interface, self._command_interface)
        return [one for one in both if one.get_names()]

    def write(self) -> None:
        """Set the outputs to their commands. Control thread."""
        for index, low, high in self._outputs:
            # A command that is no number is a fault of its controller: ignore it.
            value = self._commands[index]
            if value == value:
                self.states[index] = min(max(value, low), high)

    def reset(self) -> None:
        """Put all values back to the start."""
        for index, value in enumerate(self._initial):
            self.states[index] = self._commands[index] = value
