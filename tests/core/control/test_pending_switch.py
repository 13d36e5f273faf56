"""A switch belongs to the control thread or to its caller, never to both."""

import pytest

from station.core.control.pending_switch import PendingSwitch, SwitchProgress, refused
from station.core.control.switching import SwitchPlan, SwitchRequest
from station.core.errors import SwitchRefusedError
from station.core.hardware.robot_hw import ControllerInfo

INFO = ControllerInfo("arm", "test/Type", ())
PLAN = SwitchPlan(("arm",), (), (INFO,), (), (INFO,), ())


def pending(time=1.0, **request):
    return PendingSwitch(SwitchRequest(start=["arm"], **request), PLAN, [], [], time)


def test_only_one_gets_it():
    switch = pending()

    assert switch.claim.acquire(blocking=False)
    assert not switch.claim.acquire(blocking=False)


def test_finishing_wakes_the_caller():
    switch = pending()
    assert not switch.done.acquire(blocking=False)

    switch.finish(7)

    assert switch.done.acquire(blocking=False)
    assert switch.progress is SwitchProgress.FINISHED
    assert switch.result().cycle == 7


@pytest.mark.parametrize(
    ("timeout", "time", "late"),
    [(0.0, 99.0, False), (0.1, 1.1, False), (0.1, 1.11, True)],
)
def test_it_is_late_after_its_timeout_and_never_without_one(timeout, time, late):
    assert pending(timeout=timeout).is_late(time) is late


def test_it_is_late_when_its_caller_gives_up():
    switch = pending()
    switch.expired = True

    assert switch.is_late(1.0)
    assert "station time stands still" in switch.lateness(1.0)  # e.g. paused
    assert "not ready in time" in switch.lateness(1.5)


def test_a_controller_that_was_started_after_all_has_not_failed():
    switch = pending()
    switch.failed["arm"] = "the hardware could not switch"

    switch.note_start("arm", None)
    switch.finish(1)

    assert switch.result().ok
    assert switch.result().started == ("arm",)


def test_a_refusal_is_raised_where_the_result_is_read():
    switch = pending()
    switch.jump["j1"] = 2.0
    switch.error = refused("arm", "it is broken", switch)
    switch.finish(1)

    with pytest.raises(SwitchRefusedError, match="'arm' did not start") as caught:
        switch.result()
    assert caught.value.details["jump"] == {"j1": 2.0}
