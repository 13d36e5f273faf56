"""Wire models of experiments, excitations and measurements."""

import pytest
from pydantic import TypeAdapter, ValidationError

from station.wire import ExperimentRequest
from station.wire.excitations import BenchRequest, Command, Push, Sine, Step


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


COMMAND = TypeAdapter(Command)


def test_kind_decides_which_excitation_it_is():
    sine = {"kind": "sine", "joint": "j", "amplitude": 0.1, "frequency": 2}
    push = {"kind": "push", "link": "l", "at": 0, "lasts": 1, "force": [0, 1, 0]}

    assert COMMAND.validate_python(sine) == Sine(joint="j", amplitude=0.1, frequency=2)
    assert COMMAND.validate_python(push) == Push(
        link="l", at=0, lasts=1, force=(0.0, 1.0, 0.0)
    )


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"kind": "sine", "joint": "j", "amplitude": 1.0, "frequency": 0}, "frequency"),
        ({"kind": "step", "joint": "j", "amplitude": "1"}, "amplitude"),
        ({"kind": "step", "joint": "j", "amplitude": 1.0, "until": 1}, "until"),
        (
            {"kind": "waypoints", "joint": "j", "times": [1, 1], "values": [0, 1]},
            "increase",
        ),
        ({"kind": "recorded", "joint": "j", "times": [1], "values": [0, 1]}, "values"),
    ],
)
def test_what_is_no_excitation_is_refused_with_the_field(wrong, field):
    with pytest.raises(ValidationError, match=field):
        COMMAND.validate_python(wrong)


def test_the_kind_is_sent_though_nobody_has_written_it():
    """A client sends only what was set, and the station needs the kind."""
    sent = Step(joint="j", amplitude=0.1).model_dump(exclude_unset=True)

    assert COMMAND.validate_python(sent) == Step(joint="j", amplitude=0.1)


STEP = {"kind": "step", "joint": "j", "amplitude": 0.1}


def test_an_excitation_is_enough():
    assert BenchRequest.model_validate({"excitation": STEP}).duration == 2.0


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ({"duration": 11.0}, "duration"),
        ({"excitation": {**STEP, "kind": "push"}}, "excitation"),
        ({"excitation": {**STEP, "kind": "waypoints"}}, "excitation"),
        ({"settling_band": 1.0}, "settling_band"),
    ],
)
def test_what_is_no_measurement_is_refused_with_the_field(wrong, field):
    with pytest.raises(ValidationError, match=field):
        BenchRequest.model_validate({"excitation": STEP, **wrong})
