"""The latched stop over HTTP."""

import pytest

from station.client import ApiError
from station.core.loop.stop_latch import StopState
from tests.api.conftest import VIEWER


def test_a_stop_latches_and_is_released_in_two_steps(spring):
    stopped = spring.stop("smoke")
    assert (stopped.state, stopped.reason) == ("stopped", "smoke")
    assert spring.controller("spring").state == "stopped"

    with pytest.raises(ApiError) as caught:
        spring.release_stop(arm=True)
    assert (caught.value.status, caught.value.code) == (423, "stopped")

    assert spring.release_stop().state == "released"
    assert spring.release_stop(arm=True).state == "armed"
    assert spring.stop_state().state == "armed"
    assert spring.controller("spring").state == "stopped"


def test_stopping_twice_is_fine(spring):
    assert spring.stop("a").state == "stopped"
    assert spring.stop("b").state == "stopped"


def test_a_stop_needs_no_body_and_says_who(http):
    answer = http.post("/api/v1/stop", headers={"Authorization": f"Bearer {VIEWER}"})

    assert answer.json()["state"] == "stopped"
    assert "viewer" in answer.json()["reason"]


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ("{", "application/json"),
        ('{"reason": 7}', "application/json"),
        ('{"nonsense": true}', "application/json"),
        ("reason=fire", "application/x-www-form-urlencoded"),
    ],
)
def test_no_body_keeps_the_robot_from_stopping(operator, station, body, kind):
    answer = operator.post("/api/v1/stop", content=body, headers={"Content-Type": kind})

    assert station.loop.stop_latch.state is StopState.STOPPED, answer.text


def test_the_reason_is_read_whatever_the_body_is_called(operator):
    answer = operator.post("/api/v1/stop", content='{"reason": "smoke"}')

    assert answer.json()["reason"] == "smoke"


def test_the_answer_has_the_epoch_that_the_stop_began(spring, station):
    before = station.epoch

    stopped = spring.stop("smoke")

    assert (stopped.epoch, stopped.pending) == (before + 1, False)
