"""Named sets of gains on disk: saved, compared, applied. One YAML file each."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path

from station.core.errors import (
    GainSetError,
    GainSetNotFoundError,
    InvalidGainError,
    show,
    suggest,
)
from station.core.facade.gain_tuning import GainTuning
from station.core.user_files import user_folder
from station.library.yaml_folder import FileKind, YamlFolder
from station.reports import GainDifference, GainsChange

_KIND = FileKind("gain set", "gain-sets", GainSetNotFoundError, GainSetError)

GainsByController = dict[str, dict[str, float]]


@dataclass(frozen=True, slots=True)
class GainSet:
    """A saved set.

    Attributes:
        name: Its name.
        saved_at: When it was saved, ISO 8601.
        gains: Values by controller and name.
    """

    name: str
    saved_at: str
    gains: GainsByController


def default_folder() -> Path:
    """Return the folder of this user's gain sets."""
    return user_folder(_KIND.folder)


class GainSets:
    """The gain sets in a folder. Any thread.

    Args:
        tuning: Reads and changes the gains in force.
        folder: Where the files are; the user's own folder when None. It is made when
            the first set is saved.
    """

    def __init__(self, tuning: GainTuning, folder: Path | None = None) -> None:
        self._tuning = tuning
        self._files = YamlFolder(_KIND, folder)

    @property
    def folder(self) -> Path:
        """Return the folder of the files."""
        return self._files.folder

    def names(self) -> list[str]:
        """Return the names of all sets, sorted."""
        return self._files.names()

    def get(self, name: str) -> GainSet:
        """Return a set.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or is malformed.
        """
        data = self._files.read(name)
        try:
            gains = _checked(data.get("gains"))
        except ValueError as error:
            raise self._files.unusable(name, error) from error
        return GainSet(name, str(data.get("saved_at", "")), gains)

    def save(self, name: str, controllers: Iterable[str] | None = None) -> GainSet:
        """Save the gains in force under a name; a set of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Controllers; all loaded controllers when None.

        Raises:
            GainSetError: The name is none, or the file cannot be written.
            ControllerNotFoundError: A controller is not loaded.
        """
        if controllers is None:
            gains = self._tuning.all_gains()
        else:
            gains = {
                each: dict(self._tuning.gains(each).values) for each in controllers
            }
        now = datetime.now(UTC).isoformat(timespec="seconds")
        found = GainSet(name, now, gains)
        with self._files.changing(name):
            self._files.write(name, {"saved_at": now, "gains": gains})
        return found

    def delete(self, name: str) -> GainSet:
        """Delete a set and return it.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or deleted.
        """
        with self._files.changing(name):
            found = self.get(name)
            self._files.delete(name)
        return found

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


def _checked(gains: object) -> GainsByController:
    """Return the gains that a file has.

    Raises:
        ValueError: The values are malformed; the message says how.
    """
    if not isinstance(gains, dict):
        raise ValueError("it has no mapping 'gains'")  # noqa: TRY004 - of a file
    checked: GainsByController = {}
    for controller, values in gains.items():
        if not isinstance(values, dict):
            raise ValueError(f"the gains of '{controller}' are no mapping")  # noqa: TRY004
        for gain, value in values.items():
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not is_number or not isfinite(value):
                what = f"gain '{gain}' of '{controller}' is {show(value)}"
                raise ValueError(f"{what}, which is no finite number")
        checked[str(controller)] = {str(k): float(v) for k, v in values.items()}
    return checked
