"""The PID answers as the recorded original does, and reads its parameter names."""

import gzip
import json
from math import copysign, inf, nan
from pathlib import Path

import pytest

from station.core.errors import InvalidGainError, ParameterError
from station.core.numerics.pid import Pid, PidGains
from station.core.parameters import Parameters, ParameterTree

VECTORS = Path(__file__).parents[2] / "data" / "vectors" / "pid.json.gz"


@pytest.fixture(scope="module")
def recorded():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)


def make_gains(values):
    names = ("p", "i", "d", "i_max", "i_min", "antiwindup")
    return PidGains(**{name: values[name] for name in names})


def play(pid, step):
    """Carry out a step; return what it computed, or None."""
    match step["op"]:
        case "setGains":
            pid.set_gains(make_gains(step))
        case "reset":
            pid.reset()
        case "reset2":
            pid.reset_to(step["d_error"], step["i_error"])
        case "computeCommand":
            return pid.compute_command(float(step["error"]), step["dt"])
        case "computeCommand3":
            error, rate = float(step["error"]), float(step["error_dot"])
            return pid.compute_command_with_rate(error, rate, step["dt"])
    return None


def bits(values):
    return ["nan" if v != v else (v, copysign(1.0, v)) for v in map(float, values)]


@pytest.mark.parametrize("tag", ["random", "bad_values"])
def test_commands_and_errors_equal_the_recorded_ones_bit_by_bit(tag, recorded):
    played = 0
    for sequence in recorded["sequences"]:
        if sequence["tag"] != tag:
            continue
        pid = Pid(make_gains(sequence["gains"]))
        for step in sequence["steps"]:
            command = play(pid, step)
            if command is None:
                continue
            got = (command, pid.get_current_command(), *pid.get_current_pid_errors())
            keys = ("cmd", "getCurrentCmd", "pe", "ie", "de")
            assert bits(got) == bits(step[key] for key in keys)
            played += 1
    assert played > 1000


def test_copy_has_the_gains_but_no_errors(recorded):
    (case,) = recorded["copy_cases"]
    pid = Pid(PidGains(*case["gains"]))
    pid.compute_command(1.0, 0.1)
    copy = pid.copy()
    assert copy.gains == PidGains(*case["gains"])
    assert list(copy.get_current_pid_errors()) == case["errors"]


def test_new_gains_keep_the_integral():
    pid = Pid(PidGains(i=1.0, i_max=inf, i_min=-inf))
    pid.compute_command(2.0, 0.5)
    pid.set_gains(PidGains(i=3.0, i_max=inf, i_min=-inf))
    assert pid.compute_command(0.0, 0.5) == 3.0


def test_current_command_can_be_set():
    pid = Pid()
    pid.set_current_command(4.0)
    assert pid.get_current_command() == 4.0


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"p": nan}, "p is nan"),
        ({"i": inf}, "i is inf"),
        ({"d": -inf}, "d is -inf"),
        ({"i_max": -1.0, "i_min": 1.0}, "1.0 to -1.0"),
        ({"i_max": nan}, "nan"),
    ],
)
def test_impossible_gains_are_refused_with_their_value(values, part):
    with pytest.raises(InvalidGainError, match=part):
        PidGains(**values)


@pytest.mark.parametrize("form", ["", "pid", "gains"])
def test_gains_are_read_directly_or_below_pid_or_gains(form):
    values = {"p": 600, "i": 1.5, "d": 30.0, "i_clamp": -2.0, "antiwindup": True}
    tree = ParameterTree({form: values} if form else values)
    pid = Pid.from_parameters(Parameters(tree))
    assert pid.gains == PidGains(600.0, 1.5, 30.0, 2.0, -2.0, antiwindup=True)


def test_only_p_is_required():
    pid = Pid.from_parameters(Parameters(ParameterTree({"p": 5.0})))
    assert pid.gains == PidGains(p=5.0)


@pytest.mark.parametrize(
    ("values", "i_max", "i_min"),
    [
        ({"i_clamp": 3.0, "i_clamp_min": -1.0}, 3.0, -1.0),
        ({"i_clamp": 3.0, "i_clamp_max": 1.0}, 1.0, -3.0),
        ({"i_clamp_min": 4.0, "i_clamp_max": -2.0}, 2.0, -4.0),
    ],
)
def test_each_side_of_the_clamp_can_be_given(values, i_max, i_min):
    gains = PidGains.from_parameters(Parameters(ParameterTree({"p": 1.0, **values})))
    assert (gains.i_max, gains.i_min) == (i_max, i_min)


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"arm": {"i": 1.0}}, "arm/p"),
        ({"arm": {"pid": {"p": "much"}}}, "arm/pid/p"),
        ({"arm": {"p": 1.0, "i_clamp": True}}, "arm/i_clamp"),
        ({"arm": {"p": 1.0, "antiwindup": 1}}, "arm/antiwindup"),
    ],
)
def test_wrong_parameter_is_refused_with_its_path(values, path):
    with pytest.raises(ParameterError, match=f"'{path}'"):
        Pid.from_parameters(Parameters(ParameterTree(values), "arm"))
