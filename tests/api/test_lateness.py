"""Changes that come too late are refused; a stop never is."""

import pytest

from station.api.dependencies import CLOCK_HEADER, NOT_AFTER_HEADER, refuse_late
from station.api.errors import ProblemError
from tests.api.test_errors import problem_of

SWITCH = "/api/v1/controllers/switch"


def _clock(client):
    return float(client.get("/api/v1/status").headers[CLOCK_HEADER])


def test_a_change_is_begun_until_the_time_that_it_names():
    refuse_late({}, lambda: 1000.0)
    refuse_late({NOT_AFTER_HEADER: "1000.0"}, lambda: 1000.0)
    with pytest.raises(ProblemError, match=r"2\.0 s too late"):
        refuse_late({NOT_AFTER_HEADER: "1000.0"}, lambda: 1002.0)


@pytest.mark.parametrize("told", ["nan", "inf", "-inf", "soon", ""])
def test_what_is_no_time_is_refused(told):
    with pytest.raises(ProblemError, match="it is seconds since 1970"):
        refuse_late({NOT_AFTER_HEADER: told})


def test_a_late_change_is_refused_and_recorded_with_its_sender(operator, spring):
    late = {NOT_AFTER_HEADER: str(_clock(operator) - 1.0)}
    stop = {"stop": ["spring"]}

    problem_of(operator.post(SWITCH, json=stop, headers=late), 412, "expired")

    assert spring.controller("spring").state == "running"
    event = spring.events(kinds=["request"])[-1]
    assert (event.who, event.result) == ("operator", "412 expired")
    early = {NOT_AFTER_HEADER: str(_clock(operator) + 60.0)}
    assert operator.post(SWITCH, json=stop, headers=early).is_success


def test_a_late_stop_stops(operator, station):
    late = {NOT_AFTER_HEADER: str(_clock(operator) - 100.0)}
    assert operator.post("/api/v1/stop", headers=late).is_success
    station.loop.step()
    assert operator.get("/api/v1/stop").json()["state"] == "stopped"
