"""A tab whose widgets command a running controller."""

from abc import abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager

from typing_extensions import override

from station.client import ApiError
from station.ui.operate_model import Operated
from station.ui.panels.panel import Panel
from station.ui.reporter import Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView


class CommandingPanel(Panel):
    """Commands one controller, and lets go when the station is not as it was before.

    Args:
        link: The station.
        reporter: Shows what the station refuses.
    """

    def __init__(self, link: StationLink, reporter: Reporter) -> None:
        super().__init__(link, reporter)
        self._operated = Operated()
        self._epoch: int | None = None

    @abstractmethod
    def let_go(self) -> None:
        """Forget the motion that a person asked for, and send no more for it."""

    @override
    def watched(self) -> set[str]:
        """Return the controller that the widgets command."""
        return {self._operated.name} if self._operated.name else set()

    def _operate(self, operated: Operated, view: StationView) -> None:
        """Command `operated` from now on.

        After a stop, a reset or a recovery (a new epoch), and with another controller,
        the motion that was asked for before must not go on by itself.
        """
        is_other = operated.name != self._operated.name or view.epoch != self._epoch
        if operated.reason or is_other:
            self.let_go()
        self._operated, self._epoch = operated, view.epoch

    @contextmanager
    def _letting_go_when_refused(self) -> Iterator[None]:
        """Let go when the station refuses a request, and show the refusal."""
        try:
            yield
        except ApiError as error:
            self.let_go()
            self._reporter.refused(error, None)
