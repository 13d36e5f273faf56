"""A parameter is read through its declaration, which bounds and describes it."""

from math import inf

import pytest

from station.core.declared_parameter import (
    EACH_JOINT,
    DeclaredParameter,
    NameKind,
    ParameterType,
)
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree

GAIN = DeclaredParameter(
    name="gain",
    type=ParameterType.NUMBER,
    unit="Nm/rad",
    default=20.0,
    minimum=0.0,
    maximum=100.0,
    description="pull towards the target",
)
JOINTS = DeclaredParameter(
    name="joints",
    type=ParameterType.STRINGS,
    names=NameKind.JOINT,
    description="the joints",
)
MODE = DeclaredParameter(
    name="mode",
    type=ParameterType.STRING,
    default="soft",
    choices=("soft", "hard"),
    description="how it pulls",
)
SPEEDS = DeclaredParameter(
    name="speeds",
    type=ParameterType.NUMBER_OR_NUMBERS,
    unit="rad/s",
    default_text="limits of the joints",
    minimum=0.0,
    excludes_minimum=True,
    description="largest speeds",
)


def params(**values):
    return Parameters(ParameterTree({"it": values}), "it")


def test_a_value_within_the_range_is_read_and_a_missing_one_is_the_default():
    assert GAIN.read_float(params(gain=30)) == 30.0
    assert GAIN.read_float(params()) == 20.0


@pytest.mark.parametrize("value", [-0.1, 100.1])
def test_a_number_out_of_range_is_refused_with_what_is_allowed(value):
    allowed = rf"'it/gain' is {value}; it must be between 0 and 100 Nm/rad"
    with pytest.raises(ParameterError, match=allowed) as caught:
        GAIN.read_float(params(gain=value))

    assert caught.value.details == {"parameter": "it/gain"}
    assert caught.value.remedy == (
        "Correct the value, or leave the parameter out. Its meaning: pull towards the "
        "target."
    )


def test_a_required_parameter_that_is_missing_is_refused():
    assert JOINTS.is_required
    assert not GAIN.is_required
    assert not SPEEDS.is_required
    with pytest.raises(ParameterError, match="'it/joints' is missing"):
        JOINTS.read_str_list(params())


def test_only_one_of_the_choices_is_read():
    assert MODE.read_str(params()) == "soft"
    assert MODE.read_str(params(mode="hard")) == "hard"
    with pytest.raises(ParameterError, match="'elastic'; it must be one of soft, hard"):
        MODE.read_str(params(mode="elastic"))


def test_a_default_that_is_no_choice_is_refused():
    with pytest.raises(ValueError, match="default of 'mode' is 'x'"):
        DeclaredParameter(
            name="mode",
            type=ParameterType.STRING,
            default="x",
            choices=("soft",),
            description="how it pulls",
        )


@pytest.mark.parametrize(
    ("value", "speeds"), [(2, [2.0, 2.0]), ([1, 3], [1.0, 3.0]), (None, [4.0, 5.0])]
)
def test_one_number_counts_for_all_axes(value, speeds):
    given = params() if value is None else params(speeds=value)

    assert SPEEDS.read_per_axis(given, [4.0, 5.0]) == speeds


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ([1, 2, 3], "must be 2 numbers, or one for all"),
        (0, r"must be > 0 rad/s"),
        ([1, -1], r"\[1.0, -1.0\]; it must be > 0 rad/s"),
    ],
)
def test_numbers_that_do_not_fit_the_axes_are_refused(value, text):
    with pytest.raises(ParameterError, match=text):
        SPEEDS.read_per_axis(params(speeds=value), [4.0, 5.0])


def test_axes_without_a_usual_value_need_one():
    with pytest.raises(ParameterError, match="'it/speeds' is missing"):
        SPEEDS.read_per_axis(params(), [4.0, inf])


def test_a_declaration_is_moved_to_a_namespace_and_to_a_joint():
    each = DeclaredParameter(
        name=f"{EACH_JOINT}/p",
        type=ParameterType.NUMBER,
        default=1.0,
        description="gain",
    )

    assert each.inside("left").name == "left/<joint>/p"
    assert each.of("elbow").read_float(params(elbow={"p": 7})) == 7.0
