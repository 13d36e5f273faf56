"""Limits come out of parameters as recorded, over what is known already."""

import gzip
import json
from pathlib import Path

import pytest

from station.core.hardware.limits import (
    JointLimits,
    SoftJointLimits,
    joint_limits_from_parameters,
    limits_without_effect,
    soft_joint_limits_from_parameters,
)
from station.core.parameters import Parameters, ParameterTree

VECTORS = (
    Path(__file__).parents[3] / "data" / "vectors" / "joint_limits_rosparam.json.gz"
)
EARLIER = JointLimits(-9.0, 9.0, 99.0, 98.0, 97.0, 96.0, angle_wraparound=True)
EARLIER_SOFT = SoftJointLimits(-8.0, 8.0, 7.0, 6.0)
QUANTITIES = ("velocity", "acceleration", "jerk", "effort")
SOFT = {"soft_lower_limit": -1.0, "soft_upper_limit": 1.0, "k_velocity": 2.0}
POSITION = {"has_position_limits": True, "min_position": -2, "max_position": 2}
WRITTEN = {
    "x_all_false_then_values": {
        **POSITION,
        "has_position_limits": False,
        "has_velocity_limits": False,
        "max_velocity": 3.0,
    },
    "x_int_values": {
        **POSITION,
        "has_velocity_limits": True,
        "max_velocity": 3,
        "has_effort_limits": True,
        "max_effort": 7,
    },
    "x_string_flag": {"has_velocity_limits": "true", "max_velocity": 3.0},
    "x_wrap_false": {"has_position_limits": False, "angle_wraparound": False},
    "x_soft_complete": {"has_soft_limits": True, "k_position": 1.0, **SOFT},
    "x_soft_no_flag": {"k_position": 1.0, **SOFT},
    "x_negative_velocity": {"has_velocity_limits": True, "max_velocity": -1.0},
}


@pytest.fixture(scope="module")
def cases():
    with gzip.open(VECTORS, "rt") as file:
        return {
            (case["joint"], case["prefilled"]): case
            for case in json.load(file)["cases"]
        }


@pytest.fixture(scope="module")
def params():
    return Parameters(ParameterTree({"joint_limits": WRITTEN}))


def read_limits(recorded):
    found = {"angle_wraparound": recorded["angle_wraparound"]}
    if recorded["has_position_limits"]:
        found["min_position"] = recorded["min_position"]
        found["max_position"] = recorded["max_position"]
    for quantity in QUANTITIES:
        if recorded[f"has_{quantity}_limits"]:
            found[f"max_{quantity}"] = recorded[f"max_{quantity}"]
    return JointLimits(**found)


@pytest.mark.parametrize("prefilled", [False, True])
@pytest.mark.parametrize("joint", [*WRITTEN, "unknown_joint"])
def test_limits_are_those_recorded(joint, prefilled, cases, params):
    case = cases[joint, prefilled]
    earlier = EARLIER if prefilled else None
    expected = read_limits(case["limits"]) if case["getJointLimits"] else None
    assert joint_limits_from_parameters(joint, params, earlier) == expected


@pytest.mark.parametrize("prefilled", [False, True])
@pytest.mark.parametrize("joint", [*WRITTEN, "unknown_joint"])
def test_soft_limits_are_those_recorded(joint, prefilled, cases, params):
    case = cases[joint, prefilled]
    earlier = EARLIER_SOFT if prefilled else None
    soft = case["soft_limits"]
    expected = SoftJointLimits(**soft) if case["getSoftJointLimits"] else None
    assert soft_joint_limits_from_parameters(joint, params, earlier) == expected


def read(entry, reader, earlier):
    params = Parameters(ParameterTree({"joint_limits": {"elbow": entry}}))
    return reader("elbow", params, earlier)


@pytest.mark.parametrize(
    "entry",
    [
        {**POSITION, "min_position": "a"},
        {"has_position_limits": True, "max_position": 1.0},
        {"has_velocity_limits": True, "max_velocity": "3"},
        {"has_velocity_limits": 1, "max_velocity": 3.0},
        {"has_velocity_limits": True, "max_velocity": True},
        {"max_effort": 3.0},
        {"angle_wraparound": False},
    ],
)
def test_incomplete_or_mistyped_entry_leaves_earlier_limits_alone(entry):
    assert read(entry, joint_limits_from_parameters, EARLIER) == EARLIER


def test_soft_limits_need_all_four_values():
    entry = {"has_soft_limits": True, **SOFT}
    assert read(entry, soft_joint_limits_from_parameters, None) is None


def test_mistyped_soft_value_leaves_the_earlier_one_alone():
    entry = {"has_soft_limits": True, "k_position": "s", **SOFT}
    limits = read(entry, soft_joint_limits_from_parameters, EARLIER_SOFT)
    assert limits == SoftJointLimits(-1.0, 1.0, 7.0, 2.0)


def test_every_kind_of_limit_is_read():
    written = {"angle_wraparound": True, **POSITION}
    for number, quantity in enumerate(QUANTITIES, start=1):
        written[f"has_{quantity}_limits"] = True
        written[f"max_{quantity}"] = number
    params = Parameters(ParameterTree({"arm": {"joint_limits": {"elbow": written}}}))
    limits = joint_limits_from_parameters("elbow", params.namespace("arm"))
    assert limits == JointLimits(-2.0, 2.0, 1.0, 2.0, 3.0, 4.0)


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        ({"has_velocity_limits": True, "max_velocity": 1}, None),
        ({"has_velocity_limits": False, "max_velocity": 0}, None),
        ({"has_position_limits": False, "angle_wraparound": True}, None),
        ({"has_velocity_limit": True}, "has_velocity_limit is unknown. Did you mean"),
        ({"max_velocity": 1.0}, "max_velocity counts only with 'has_velocity_limits"),
        ({"has_effort_limits": True}, "without a number for 'max_effort'"),
        ({"has_effort_limits": True, "max_effort": "9"}, "without a number"),
        ({"has_effort_limits": "yes", "max_effort": 9}, "must be true or false"),
        ({"k_velocity": 1.0}, "k_velocity counts only with 'has_soft_limits: true'"),
        (1.0, "joint_limits/elbow is 1.0; it must be a mapping"),
    ],
)
def test_limits_without_effect_are_found(entry, told):
    params = Parameters(ParameterTree({"joint_limits": {"elbow": entry}}))
    found = limits_without_effect(params, ["elbow"])
    assert (told is None and not found) or told in found[0]
    assert all("joint_limits/elbow" in each for each in found)


def test_limits_of_a_joint_that_is_none_are_found():
    params = Parameters(ParameterTree({"joint_limits": {"elbo": {}}}))
    (found,) = limits_without_effect(params, ["elbow", "wrist"])
    assert found.startswith("joint_limits/elbo names no joint. Did you mean 'elbow'?")
    assert limits_without_effect(Parameters(), []) == []
