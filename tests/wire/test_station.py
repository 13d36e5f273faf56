"""Wire models of the station's status, events, alarms and people."""

from typing import get_args

import pytest
from pydantic import ValidationError

from station.events import EventKind, Severity
from station.reports import examples_of
from station.wire import (
    Alarm,
    Alarms,
    ControlRequest,
    JointStates,
    LoginRequest,
    ReleaseRequest,
    StopRequest,
    TokenRequest,
)
from station.wire.records import EventKindName, SeverityName


def test_the_example_of_joint_states_is_valid():
    (example,) = examples_of(JointStates.__doc__)

    assert JointStates.model_validate(example)


def test_a_release_does_not_arm_by_itself():
    assert ReleaseRequest().arm is False


@pytest.mark.parametrize("arm", [1, "true", None])
def test_arming_is_true_or_false(arm):
    with pytest.raises(ValidationError):
        ReleaseRequest.model_validate({"arm": arm})


def test_texts_have_an_end():
    with pytest.raises(ValidationError):
        StopRequest(reason="x" * 501)
    with pytest.raises(ValidationError):
        LoginRequest(token="")


def test_kinds_and_severities_are_those_of_the_log():
    assert set(get_args(EventKindName)) == {kind.value for kind in EventKind}
    assert list(get_args(SeverityName)) == [severity.value for severity in Severity]


SEEN = {
    "id": 3,
    "subject": "stop",
    "severity": "warning",
    "text": "The station is stopped.",
    "remedy": "Release the stop.",
    "raised_at": 1.0,
    "cleared_at": None,
    "acknowledged_by": "ada",
    "acknowledged_at": 2.0,
}


def test_an_alarm_travels_unchanged():
    alarms = Alarms.model_validate({"alarms": [SEEN], "unacknowledged": 0})

    assert alarms.alarms == [Alarm.model_validate(SEEN)]
    assert alarms.model_dump(mode="json")["alarms"] == [SEEN]


@pytest.mark.parametrize("name", ["Ada", "Dr. Grace Hopper", "ada@lab", "Ölaf"])
def test_people_have_names(name):
    assert ControlRequest(owner=name).owner == name


@pytest.mark.parametrize("name", ["", " Ada", "a\nb", "x" * 101])
def test_what_would_garble_a_log_is_no_name(name):
    with pytest.raises(ValidationError):
        ControlRequest(owner=name)


@pytest.mark.parametrize("expires", [0.0, -1.0, float("inf"), "60"])
def test_a_token_lives_for_a_finite_time(expires):
    with pytest.raises(ValidationError):
        TokenRequest(name="ada", expires=expires)
