"""Wire models of the station itself."""

import pytest
from pydantic import ValidationError

from station.reports import examples_of
from station.wire import JointStates, LoginRequest, ReleaseRequest, StopRequest


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
