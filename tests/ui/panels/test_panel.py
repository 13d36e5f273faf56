"""Panel: the base of all tabs of the dashboard."""

from station.ui.panels.panel import Panel


class _Tab(Panel):
    def refresh(self, view):
        self.seen = view


def test_a_tab_without_watched_controllers_needs_no_samples():
    assert _Tab(link=None, reporter=None).watched() == set()
