"""What all tabs share."""

from station.ui.panels.panel import Panel


class _Tab(Panel):
    def refresh(self, view):
        self.seen = view


def test_a_tab_watches_no_controller_unless_it_says_so():
    assert _Tab().watched() == set()
