"""Plot layouts on disk: which plots a page shows, under a name."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import inf
from pathlib import Path

from pydantic import TypeAdapter
from typing_extensions import override

from station.core.errors import PlotLayoutError, PlotLayoutNotFoundError
from station.library.yaml_folder import FileKind, Library
from station.reports import PlotLayout, PlotSettings

_KIND = FileKind(
    "plot layout", "plot-layouts", PlotLayoutNotFoundError, PlotLayoutError
)
_PLOTS = TypeAdapter(tuple[PlotSettings, ...])


class PlotLayouts(Library[PlotLayout]):
    """The plot layouts in a folder. Any thread.

    Args:
        folder: Where the files are; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        super().__init__(_KIND, folder)

    def save(self, name: str, plots: Sequence[PlotSettings]) -> PlotLayout:
        """Save a layout; one of that name is replaced.

        Raises:
            PlotLayoutNotFoundError: The name is none.
            PlotLayoutError: The file cannot be written.
        """
        with self._files.changing(name):
            now = self._write(name, "plots", [asdict(plot) for plot in plots])
        return PlotLayout(name, now, tuple(plots))

    @override
    def _parse(
        self, name: str, saved_at: str, data: Mapping[str, object]
    ) -> PlotLayout:
        plots = _PLOTS.validate_python(data.get("plots"))
        for number, plot in enumerate(plots, 1):
            if not 0.0 < plot.span < inf:
                raise ValueError(f"its plot {number} shows {plot.span} s")
        return PlotLayout(name, saved_at, plots)
