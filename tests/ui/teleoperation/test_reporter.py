"""A failure of a callback reaches the screen and the log."""

import asyncio
import logging

import pytest
from viser import GuiEvent

from station.client import ApiError
from station.ui.teleoperation.reporter import Reporter
from station.wire import CommandElement


class _Browser:
    def __init__(self):
        self.shown = []

    def add_notification(self, title, body, **_):
        self.shown.append((title, body))


@pytest.fixture
def browser():
    return _Browser()


@pytest.fixture
def reporter():
    return Reporter(lambda: 0.0)


def _press(reporter, browser, failure):
    async def callback(_event):
        if failure:
            raise failure

    event = GuiEvent(client=browser, client_id=1, target=None)
    asyncio.run(reporter.guarded(callback)(event))


def test_a_reported_refusal_has_the_words_of_the_station(reporter, browser):
    refusal = ApiError("No arm.", status=404, code="not_found", remedy="Load it.")
    _press(reporter, browser, refusal)
    assert browser.shown == [("not_found", "No arm. Load it.")]
    assert reporter.message == "not_found: No arm. Load it."


def test_any_other_failure_is_logged_and_shown(reporter, browser, caplog):
    with caplog.at_level(logging.ERROR):
        _press(reporter, browser, ZeroDivisionError("oops"))
    assert browser.shown == [("The dashboard failed", "ZeroDivisionError: oops")]
    assert "oops" in caplog.text


def test_values_that_do_not_fit_are_named(reporter, browser):
    with pytest.raises(ValueError, match="unit") as caught:
        CommandElement.model_validate({"name": "a"})
    _press(reporter, browser, caught.value)
    assert browser.shown == [("Not valid", "CommandElement.unit: Field required.")]


def test_the_dashboards_own_changes_are_no_actions(reporter):
    _press(reporter, None, ZeroDivisionError("must not run"))
    assert reporter.message == ""


def test_messages_fade():
    now = [0.0]
    reporter = Reporter(lambda: now[0])
    reporter.say("Refused", "No.", None)
    now[0] = 60.0
    assert reporter.message == ""
