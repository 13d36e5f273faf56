"""Gains on disk: named sets to save, compare and apply, and files of ros_control.

A file of ros_control has the parameters of a controller with its gains in force.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import yaml
from pydantic import FiniteFloat, Strict, TypeAdapter
from typing_extensions import override

from station.core.control.tunables import Tunables
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.errors import (
    GainSetError,
    GainSetNotFoundError,
    InvalidGainError,
    suggest,
)
from station.core.facade.gain_tuning import GainTuning
from station.core.facade.station import Station
from station.core.parameters import Parameters, ParameterTree
from station.core.user_files import user_folder
from station.library.yaml_folder import FileKind, Library
from station.reports import GainDifference, GainsChange

_KIND = FileKind("gain set", "gain-sets", GainSetNotFoundError, GainSetError)

GainsByController = dict[str, dict[str, float]]
# Strict, because YAML's `true` would otherwise count as the number 1.
_GAINS: TypeAdapter[GainsByController] = TypeAdapter(
    dict[str, dict[str, Annotated[FiniteFloat, Strict()]]]
)
_ELEMENT = re.compile(r"(.+)\[\d+\]")


@dataclass(frozen=True, slots=True)
class GainSet:
    """A saved set of gains.

    Attributes:
        name: Its name.
        saved_at: When it was saved, ISO 8601.
        gains: Values by controller and name of the gain, in the unit of the gain.
    """

    name: str
    saved_at: str
    gains: GainsByController


def default_folder() -> Path:
    """Return the folder of this user's gain sets."""
    return user_folder(_KIND.folder)


class GainSets(Library[GainSet]):
    """The gain sets in a folder. Any thread.

    Args:
        tuning: Reads and changes the gains in force.
        folder: Folder of the files; the user's own folder when None. It is made when
            the first set is saved.
    """

    def __init__(self, tuning: GainTuning, folder: Path | None = None) -> None:
        self._tuning = tuning
        super().__init__(_KIND, folder)

    def save(self, name: str, controllers: Iterable[str] | None = None) -> GainSet:
        """Save the gains in force under a name; a set of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Controllers; all loaded controllers when None.

        Raises:
            GainSetError: The name is not allowed, or the file cannot be written.
            ControllerNotFoundError: A controller is not loaded.
        """
        if controllers is None:
            gains = self._tuning.all_gains()
        else:
            gains = {
                each: dict(self._tuning.gains(each).values) for each in controllers
            }
        with self._files.changing(name):
            return GainSet(name, self._write(name, {"gains": gains}), gains)

    def differences(self, name: str) -> list[GainDifference]:
        """Return the differences between a set and the gains in force.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or is malformed.
        """
        present = self._tuning.all_gains()
        found = []
        for controller, saved in self.get(name).gains.items():
            now = present.get(controller, {})
            for gain in dict.fromkeys((*saved, *now)):
                one, other = saved.get(gain), now.get(gain)
                if one != other:
                    found.append(GainDifference(controller, gain, one, other))
        return found

    def apply(
        self, name: str, controllers: Iterable[str] | None = None
    ) -> dict[str, GainsChange]:
        """Put a set into force, all of it between the same two cycles.

        Args:
            name: The set.
            controllers: Controllers; all controllers of the set when None.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or is malformed.
            ControllerNotFoundError: A controller is not loaded; nothing changed.
            InvalidGainError: A value is not allowed, or the set has no gains of a
                controller; nothing changed.
            LoopError: The loop died or hangs.
        """
        gains: Mapping[str, Mapping[str, float]] = self.get(name).gains
        if controllers is not None:
            chosen = list(controllers)
            for each in chosen:
                if each not in gains:
                    raise InvalidGainError(
                        f"The gain set '{name}' has no gains of controller '{each}'.",
                        remedy=suggest(each, gains),
                        details={"gain_set": name, "controller": each},
                    )
            gains = {each: gains[each] for each in chosen}
        return self._tuning.set_many(gains)

    @override
    def _parse(self, name: str, saved_at: str, data: Mapping[str, object]) -> GainSet:
        return GainSet(name, saved_at, _GAINS.validate_python(data.get("gains")))


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
