"""Plot layouts on disk: which plots a page shows, under a name. One YAML file each."""

from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import Any

from station.core.errors import PlotLayoutError, PlotLayoutNotFoundError
from station.library.yaml_folder import FileKind, YamlFolder
from station.reports import DockSettings, PlotLayout, PlotSettings

_KIND = FileKind(
    "plot layout", "plot-layouts", PlotLayoutNotFoundError, PlotLayoutError
)


class PlotLayouts:
    """The plot layouts in a folder. Any thread.

    Args:
        folder: Where the files are; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._files = YamlFolder(_KIND, folder)

    def names(self) -> list[str]:
        """Return the names of all layouts, sorted."""
        return self._files.names()

    def get(self, name: str) -> PlotLayout:
        """Return a layout.

        Raises:
            PlotLayoutNotFoundError: There is no layout of that name.
            PlotLayoutError: Its file cannot be read or is malformed.
        """
        data = self._files.read(name)
        try:
            plots = _read(data.get("plots"))
            docks = _docks(data.get("docks"))
        except ValueError as error:
            raise self._files.unusable(name, error) from error
        return PlotLayout(name, str(data.get("saved_at", "")), plots, docks)

    def save(
        self,
        name: str,
        plots: Sequence[PlotSettings],
        docks: DockSettings | None = None,
    ) -> PlotLayout:
        """Save a layout; one of that name is replaced.

        Args:
            name: Its name.
            plots: Its plots.
            docks: Folds and sizes of the docks; None keeps those of the layout.

        Raises:
            PlotLayoutNotFoundError: The name is none.
            PlotLayoutError: The file cannot be written.
        """
        now = datetime.now(UTC).isoformat(timespec="seconds")
        data: dict[str, Any] = {"saved_at": now, "plots": [asdict(p) for p in plots]}
        with self._files.changing(name):
            if docks is None and name in self.names():
                docks = self.get(name).docks
            if docks is not None:
                data["docks"] = asdict(docks)
            self._files.write(name, data)
        return PlotLayout(name, now, tuple(plots), docks)

    def delete(self, name: str) -> PlotLayout:
        """Delete a layout and return it.

        Raises:
            PlotLayoutNotFoundError: There is no layout of that name.
            PlotLayoutError: Its file cannot be read or deleted.
        """
        with self._files.changing(name):
            found = self.get(name)
            self._files.delete(name)
            return found


def _docks(docks: object) -> DockSettings | None:
    """Return the docks that a file has; None without any.

    Raises:
        ValueError: The values are malformed.
    """
    if docks is None:
        return None
    try:
        made = DockSettings(**docks)  # type: ignore[arg-type]  # refused below
        heights = {str(name): float(size) for name, size in made.heights.items()}
        folded = [str(name) for name in made.folded]
        return DockSettings(folded, float(made.side), float(made.below), heights)
    except (AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"its docks are malformed: {error!r}") from error


def _read(plots: object) -> tuple[PlotSettings, ...]:
    """Return the plots that a file has.

    Raises:
        ValueError: The values are malformed; the message says how.
    """
    if not isinstance(plots, list):
        raise ValueError("it has no list 'plots'")  # noqa: TRY004 - of a file
    found = []
    for number, each in enumerate(plots, 1):
        try:
            keys = [str(key) for key in each["keys"]]
            span = float(each["span"])
            found.append(
                PlotSettings(keys, bool(each["xy"]), span, str(each["transform"]))
            )
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"its plot {number} is malformed: {error!r}") from error
        if not isfinite(span) or span <= 0.0:
            raise ValueError(f"its plot {number} shows {span} s")
    return tuple(found)
