"""What every tab of the dashboard is."""

from abc import ABC, abstractmethod

from station.ui.station_view import StationView


class Panel(ABC):
    """One tab. Built once; used from Viser's event loop only."""

    @abstractmethod
    def refresh(self, view: StationView) -> None:
        """Show `view`; called about ten times a second."""

    def watched(self) -> set[str]:
        """Return the controllers whose samples this tab needs."""
        return set()
