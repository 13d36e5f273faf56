"""Experiments on the wire: what a request may not ask."""

import pytest
from pydantic import ValidationError

from station.wire import ExperimentRequest


def test_a_request_needs_a_kind_and_a_controller_alone():
    found = ExperimentRequest(kind="tune", controller="arm")

    assert (found.trials, found.weights, found.bounds) == (
        100,
        {"rms_error": 1.0},
        None,
    )


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"kind": "guess"}, "kind"),
        ({"controller": ""}, "controller"),
        ({"name": "../x"}, "name"),
        ({"trials": 0}, "trials"),
        ({"duration": 0.0}, "duration"),
        ({"joints": []}, "joints"),
        ({"workers": 0}, "workers"),
        ({"parameters": {"load": float("nan")}}, "parameters"),
        ({"commands": [{"kind": "jump"}]}, "commands"),
        ({"speed": 1.0}, "speed"),
    ],
)
def test_what_is_no_experiment_is_refused_with_the_field(wrong, field):
    request = {"kind": "tune", "controller": "arm", **wrong}

    with pytest.raises(ValidationError, match=field):
        ExperimentRequest.model_validate(request)
