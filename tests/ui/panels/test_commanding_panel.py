"""CommandingPanel: when a motion that a person asked for must not go on."""

from types import SimpleNamespace

import pytest

from station.client import ApiError
from station.ui.operate_model import Operated
from station.ui.panels.commanding_panel import CommandingPanel


class _Panel(CommandingPanel):
    def __init__(self, reporter=None):
        super().__init__(link=None, reporter=reporter)
        self.times_let_go = 0

    def refresh(self, view):
        self._operate(view.operated, view)

    def let_go(self):
        self.times_let_go += 1

    def send(self, error):
        with self._letting_go_when_refused():
            raise error


def _view(name, epoch=1, reason=""):
    return SimpleNamespace(operated=Operated(name, reason=reason), epoch=epoch)


@pytest.fixture
def panel():
    panel = _Panel()
    panel.refresh(_view("arm"))
    panel.times_let_go = 0
    return panel


def test_a_motion_goes_on_while_nothing_changes(panel):
    panel.refresh(_view("arm"))

    assert panel.times_let_go == 0
    assert panel.watched() == {"arm"}


@pytest.mark.parametrize(
    "changed",
    [_view("other"), _view("arm", epoch=2), _view("arm", reason="The arm is stopped.")],
    ids=["another controller", "a new epoch", "a reason not to move"],
)
def test_a_changed_station_ends_the_motion_once(panel, changed):
    panel.refresh(changed)

    assert panel.times_let_go == 1


def test_a_refusal_ends_the_motion_and_is_shown():
    shown = []
    reporter = SimpleNamespace(refused=lambda error, _client: shown.append(error))
    panel = _Panel(reporter)
    refusal = ApiError("The station is stopped.", status=423, code="stopped")

    panel.send(refusal)

    assert panel.times_let_go == 1
    assert shown == [refusal]
