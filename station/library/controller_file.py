"""The parameters of a controller as a file of ros_control, with its gains in force."""

import re

import yaml

from station.core.control.tunables import Tunables
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.facade.station import Station
from station.core.parameters import Parameters, ParameterTree

_ELEMENT = re.compile(r"(.+)\[\d+\]")


def controller_file(station: Station, name: str) -> str:
    """Return the parameters of a controller as YAML, which `--controllers` loads.

    They are those of the tree of parameters. A gain that has changed since the
    controller was loaded replaces the parameter that it comes from, or the one of its
    name. A comment names the changed gains that have neither.

    Raises:
        ControllerNotFoundError: No controller of that name is loaded.
    """
    controller = station.manager.get_controller(name)
    tree = ParameterTree({name: station.parameters.get(name, {})})
    unwritten = write_gains(
        Parameters(tree, name),
        controller.tunables,
        type(controller).declared_parameters(),
    )
    comments = [f"# No parameter of {name}: {gain}\n" for gain in unwritten]
    return "".join([
        f"# Parameters of {name} with its gains in force.\n",
        *comments,
        yaml.safe_dump(tree.get(""), sort_keys=False, allow_unicode=True),
    ])


def write_gains(
    params: Parameters, tunables: Tunables, declared: tuple[DeclaredParameter, ...]
) -> list[str]:
    """Write the changed gains of a controller into its parameters.

    Args:
        params: The controller's namespace, which is changed.
        tunables: The gains.
        declared: The parameters that the controller reads.

    Returns:
        The changed gains that have no parameter, e.g. `k_p: 0.5`.
    """
    types = {each.name: each for each in declared}
    unwritten = []
    for name, value in tunables.values.items():
        if value == tunables.configured[name]:
            continue
        path = tunables.schema[name].parameter
        if not path and (name in types or params.has(name)):
            path = name
        element = _ELEMENT.fullmatch(path)
        if element is not None:
            # The elements of a list have the order of the list.
            place = element[1]
            before = params.get(place)
            params.set(
                place,
                [
                    _typed(each, types.get(place), before)
                    for other, each in tunables.values.items()
                    if tunables.schema[other].parameter.startswith(f"{place}[")
                ],
            )
        elif path:
            params.set(path, _typed(value, types.get(path), params.get(path)))
        else:
            unwritten.append(f"{name}: {value:g}")
    return unwritten


def _typed(value: float, declared: DeclaredParameter | None, before: object) -> object:
    """Return a gain as the file has it, where a switch or a choice is no number."""
    first = before[0] if isinstance(before, list) and before else before
    if isinstance(first, bool):
        return value != 0.0
    if declared is not None and declared.type is ParameterType.BOOLEAN:
        return value != 0.0
    if declared is not None and declared.choices:
        return declared.choices[round(value)]
    return value
