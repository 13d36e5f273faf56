"""What the tabs of the dashboard have in common."""

from abc import ABC, abstractmethod

from station.ui.reporter import Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView


class Panel(ABC):
    """One tab. Built once; used from Viser's event loop only.

    Args:
        link: The station.
        reporter: Shows what the station refuses.
    """

    def __init__(self, link: StationLink, reporter: Reporter) -> None:
        self._link = link
        self._reporter = reporter

    @abstractmethod
    def refresh(self, view: StationView) -> None:
        """Show `view`; called about ten times a second."""

    def watched(self) -> set[str]:
        """Return the controllers whose samples this tab needs."""
        return set()
