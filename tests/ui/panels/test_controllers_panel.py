"""The Controllers tab, used as a person does."""

import pytest

from station.ui.panels.controllers_panel import ControllersPanel
from tests.ui.fake_station import GROUP_TYPE


@pytest.fixture
def panel(bench):
    return bench.panel(ControllersPanel)


def test_a_controller_is_started_and_stopped_by_clicking(bench, panel):
    bench.station.load("arm")
    assert bench.wait(lambda: not panel._start.disabled)
    bench.click(panel._start)
    assert bench.wait(lambda: bench.station.controllers["arm"].state == "running")
    assert bench.wait(lambda: not panel._stop.disabled)
    bench.click(panel._stop)
    assert bench.wait(lambda: bench.station.controllers["arm"].state == "stopped")


def test_starting_a_controller_in_place_of_another_shows_what_it_stops(bench, panel):
    bench.station.load("arm")
    bench.station.load("old", running=True)
    assert bench.wait(lambda: panel._start.label == "Stop old and start this")
    bench.click(panel._start)
    assert bench.wait(lambda: bench.station.controllers["arm"].state == "running")
    assert bench.station.controllers["old"].state == "stopped"


def test_a_controller_is_unloaded(bench, panel):
    bench.station.load("arm")
    assert bench.wait(lambda: panel._chosen.value == "arm")
    bench.click(panel._unload)
    assert bench.wait(lambda: "arm" not in bench.station.controllers)


def test_a_click_without_a_controller_is_answered_and_not_sent(bench, panel):
    reporter = bench.dashboard._reporter
    for button in (panel._start, panel._stop, panel._unload):
        bench.click(button)
        assert bench.wait(lambda: "No controller is loaded." in reporter.message)
        reporter.done("", None)
    assert all(request[0] == "GET" for request in bench.station.requests)


def test_the_form_is_prefilled_so_that_load_works_at_once(bench, panel):
    form = panel._load
    assert bench.wait(lambda: form._type.value == GROUP_TYPE and form._name.value)
    bench.click(form._button)
    assert bench.wait(lambda: bench.station.controllers)
    body = next(r[2] for r in bench.station.requests if r[0] == "POST")
    assert body["params"]["panda_joint1"] == {"pid": {"p": 600, "i": 0, "d": 30}}
    assert bench.wait(lambda: form._name.value != body["name"])  # a free one


def test_a_refusal_is_shown_in_the_words_of_the_station(bench, panel):
    bench.station.load("twice")
    bench.enter(panel._load._name, "twice")
    assert bench.wait(lambda: panel._load._name.value == "twice")
    bench.click(panel._load._button)
    reporter = bench.dashboard._reporter
    assert bench.wait(lambda: "controller_exists" in reporter.message)
    assert "A controller 'twice' is loaded already." in reporter.message
    assert "Choose another name." in reporter.message


@pytest.mark.parametrize(
    ("text", "complaint"), [("a: [", "not valid YAML"), ("- 1", "key: value")]
)
def test_unreadable_parameters_are_not_sent(bench, panel, text, complaint):
    bench.enter(panel._load._params, text)
    assert bench.wait(lambda: panel._load._params.value == text)
    bench.click(panel._load._button)
    assert bench.wait(lambda: complaint in panel._load._problem.content)
    assert not [r for r in bench.station.requests if r[0] == "POST"]


def test_the_table_shows_what_others_load(bench, panel):
    bench.station.load("elsewhere", running=True)
    assert bench.wait(lambda: "elsewhere" in panel._table.content, seconds=1.5)
