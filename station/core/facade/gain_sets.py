"""Named sets of gains on disk: saved, compared, applied. One YAML file each."""

import os
import re
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path

import yaml

from station.core.control.tunables import GainsChange
from station.core.errors import (
    GainSetError,
    GainSetNotFoundError,
    InvalidGainError,
    show,
    suggest,
)
from station.core.facade.gain_tuning import GainTuning

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
_LARGEST = 1_000_000
"""Largest file that is read [bytes]."""
_SUFFIX = ".yaml"
_REMEDY = "Correct or delete the file, or save the set anew."

GainsByController = dict[str, dict[str, float]]


@dataclass(frozen=True, slots=True)
class GainDifference:
    """A gain whose saved value is not the present one.

    Attributes:
        controller: The controller.
        name: The gain.
        saved: The value of the set; None when the set does not have it.
        present: The value in force; None when the controller is not loaded or has no
            such gain.
    """

    controller: str
    name: str
    saved: float | None
    present: float | None


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
    """Return where the gain sets of this user are kept."""
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / "control-station" / "gain-sets"


class GainSets:
    """The gain sets in a folder. Any thread.

    Args:
        tuning: Reads and changes the gains in force.
        folder: Where the files are; the user's own folder when None. It is made when
            the first set is saved.
    """

    def __init__(self, tuning: GainTuning, folder: Path | None = None) -> None:
        self._tuning = tuning
        self._folder = folder

    @property
    def folder(self) -> Path:
        """Where the files are."""
        return self._folder or default_folder()

    def names(self) -> list[str]:
        """Return the names of all sets, sorted."""
        try:
            found = [path.stem for path in self.folder.glob(f"*{_SUFFIX}")]
        except OSError:
            return []
        return sorted(name for name in found if _NAME.fullmatch(name))

    def get(self, name: str) -> GainSet:
        """Return a set.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or is malformed.
        """
        path = self._path(name)
        try:
            with path.open(encoding="utf-8") as file:
                text = file.read(_LARGEST + 1)
        except FileNotFoundError as error:
            raise GainSetNotFoundError(
                f"There is no gain set '{name}'.",
                remedy=suggest(name, self.names()),
                details={"gain_set": name},
            ) from error
        except (OSError, UnicodeDecodeError) as error:
            raise GainSetError(_unusable(path, error), remedy=_REMEDY) from error
        return _parsed(name, path, text)

    def save(self, name: str, controllers: Iterable[str] | None = None) -> GainSet:
        """Save the gains in force under a name; a set of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Whose gains; those of all loaded controllers when None.

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
        self._write(found)
        return found

    def delete(self, name: str) -> GainSet:
        """Delete a set and return it.

        Raises:
            GainSetNotFoundError: There is no set of that name.
            GainSetError: Its file cannot be read or deleted.
        """
        found = self.get(name)
        path = self._path(name)
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise GainSetError(_unusable(path, error), remedy=_REMEDY) from error
        return found

    def differences(self, name: str) -> list[GainDifference]:
        """Return where a set differs from the gains in force of its controllers.

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
            controllers: Whose gains; those of all controllers of the set when None.

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

    def _path(self, name: str) -> Path:
        """Return the file of a set.

        Raises:
            GainSetNotFoundError: No set can have that name.
        """
        if not _NAME.fullmatch(name):
            raise GainSetNotFoundError(
                f"{show(name)} is no name of a gain set.",
                remedy="Use letters, digits, '_', '.' and '-', 100 at most.",
                details={"gain_set": name},
            )
        return self.folder / f"{name}{_SUFFIX}"

    def _write(self, found: GainSet) -> None:
        path = self._path(found.name)
        text = yaml.safe_dump(
            {"saved_at": found.saved_at, "gains": found.gains}, sort_keys=False
        )
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            # Under another name first: whoever reads meanwhile, and whoever starts
            # after a crash, finds the old set or the new one.
            with tempfile.NamedTemporaryFile(
                "w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8"
            ) as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            Path(file.name).replace(path)
        except OSError as error:
            raise GainSetError(_unusable(path, error), remedy=_REMEDY) from error


def _parsed(name: str, path: Path, text: str) -> GainSet:
    """Return the set that a file has.

    Raises:
        GainSetError: The file is malformed.
    """
    if len(text) > _LARGEST:
        raise GainSetError(
            _unusable(path, f"it is larger than {_LARGEST} characters"), remedy=_REMEDY
        )
    try:
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise GainSetError(
            _unusable(path, f"it is no YAML: {error}"), remedy=_REMEDY
        ) from error
    gains = data.get("gains") if isinstance(data, dict) else None
    if not isinstance(gains, dict):
        raise GainSetError(_unusable(path, "it has no mapping 'gains'"), remedy=_REMEDY)
    checked: GainsByController = {}
    for controller, values in gains.items():
        if not isinstance(values, dict):
            raise GainSetError(
                _unusable(path, f"the gains of '{controller}' are no mapping"),
                remedy=_REMEDY,
            )
        for gain, value in values.items():
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not is_number or not isfinite(value):
                what = f"gain '{gain}' of '{controller}' is {show(value)}"
                raise GainSetError(
                    _unusable(path, f"{what}, which is no finite number"),
                    remedy=_REMEDY,
                )
        checked[str(controller)] = {str(k): float(v) for k, v in values.items()}
    return GainSet(name, str(data.get("saved_at", "")), checked)


def _unusable(path: Path, why: object) -> str:
    return f"The gain set in {path} cannot be used: {why}."
