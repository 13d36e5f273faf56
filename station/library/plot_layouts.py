"""Plot layouts on disk: the plots that a page shows, saved under a name."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import inf
from pathlib import Path

from pydantic import TypeAdapter
from typing_extensions import override

from station.core.errors import PlotLayoutError, PlotLayoutNotFoundError
from station.library.yaml_folder import FileKind, Library
from station.reports import DockSettings, PlotLayout, PlotSettings

_KIND = FileKind(
    "plot layout", "plot-layouts", PlotLayoutNotFoundError, PlotLayoutError
)
_PLOTS = TypeAdapter(tuple[PlotSettings, ...])
_DOCKS = TypeAdapter(DockSettings | None)


class PlotLayouts(Library[PlotLayout]):
    """The plot layouts in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        super().__init__(_KIND, folder)

    def save(
        self,
        name: str,
        plots: Sequence[PlotSettings],
        docks: DockSettings | None = None,
    ) -> PlotLayout:
        """Save a layout; it replaces a layout of the same name.

        Args:
            name: Its name.
            plots: Its plots.
            docks: Folds and sizes of the docks; None keeps those of the layout.

        Raises:
            PlotLayoutNotFoundError: The name is not allowed.
            PlotLayoutError: The file cannot be written.
        """
        with self._files.changing(name):
            if docks is None and name in self.names():
                docks = self.get(name).docks
            content: dict[str, object] = {"plots": [asdict(plot) for plot in plots]}
            if docks is not None:
                content["docks"] = asdict(docks)
            now = self._write(name, content)
        return PlotLayout(name, now, tuple(plots), docks)

    @override
    def _parse(
        self, name: str, saved_at: str, data: Mapping[str, object]
    ) -> PlotLayout:
        plots = _PLOTS.validate_python(data.get("plots"))
        for number, plot in enumerate(plots, 1):
            if not 0.0 < plot.span < inf:
                raise ValueError(f"its plot {number} shows {plot.span} s")
        return PlotLayout(
            name, saved_at, plots, _DOCKS.validate_python(data.get("docks"))
        )
