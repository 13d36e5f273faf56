"""Bounds of the error: defaults from parameters, requests of a goal, violations."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from station.core.parameters import Parameters, ParameterTree
from station.core.trajectory import (
    JointTolerances,
    StateTolerances,
    ToleranceRequest,
    read_tolerances,
    updated_tolerances,
)

FILE = (
    Path(__file__).parents[2]
    / "data/ros_yaml/joint_trajectory_controller/tolerances.yaml"
)
CONSTRAINTS = {
    "goal_time": 0.6,
    "stopped_velocity_tolerance": 0.02,
    "foo": {"trajectory": 0.05, "goal": 0.03},
    "bar": {"goal": 0.01},
}
DEFAULTS = {
    "foo": JointTolerances(StateTolerances(0.05), StateTolerances(0.03, 0.02), 0.6),
    "bar": JointTolerances(StateTolerances(), StateTolerances(0.01, 0.02), 0.6),
}


def _params(values):
    return Parameters(
        ParameterTree({"arm": {"constraints": values}}), "arm/constraints"
    )


def test_defaults_are_read_from_the_constraints():
    assert read_tolerances(_params(CONSTRAINTS), ["foo", "bar"]) == DEFAULTS


def test_the_originals_test_file_gives_its_bounds():
    params = Parameters(ParameterTree(yaml.safe_load(FILE.read_text())), "constraints")
    assert read_tolerances(params, ["foo_joint", "bar_joint"]) == {
        "foo_joint": JointTolerances(
            StateTolerances(0.05), StateTolerances(0.03, 0.02), 1.0
        ),
        "bar_joint": JointTolerances(
            StateTolerances(), StateTolerances(0.01, 0.02), 1.0
        ),
    }


def test_without_constraints_only_the_final_speed_is_bounded():
    assert read_tolerances(_params({}), ["foo"]) == {
        "foo": JointTolerances(StateTolerances(), StateTolerances(0.0, 0.01), 0.0)
    }


def test_a_positive_request_replaces_a_negative_one_removes_and_zero_keeps():
    updated = updated_tolerances(
        DEFAULTS,
        path=[ToleranceRequest("foo", position=-1.0, velocity=0.5)],
        goal=[ToleranceRequest("bar", position=0.2, acceleration=3.0)],
        goal_time=-1.0,
    )
    assert updated == {
        "foo": JointTolerances(
            StateTolerances(0.0, 0.5), StateTolerances(0.03, 0.02), 0.0
        ),
        "bar": JointTolerances(StateTolerances(), StateTolerances(0.2, 0.02, 3.0), 0.0),
    }


@pytest.mark.parametrize("what", ["position", "velocity", "acceleration"])
@pytest.mark.parametrize(("request_", "after"), [(0.0, None), (-1.0, 0.0), (0.5, 0.5)])
def test_a_request_changes_its_own_quantity_alone(what, request_, after):
    default = StateTolerances(1.0, 2.0, 3.0)
    tolerances = {"foo": JointTolerances(default, default, 1.0)}
    request = ToleranceRequest("foo", **{what: request_})
    updated = updated_tolerances(tolerances, [request], [], 0.0)["foo"]
    expected = default if after is None else replace(default, **{what: after})
    assert updated == JointTolerances(expected, default, 1.0)


@pytest.mark.parametrize(("goal_time", "after"), [(0.0, 1.0), (2.0, 2.0), (-1.0, 0.0)])
def test_the_goal_time_follows_the_same_rule(goal_time, after):
    defaults = {"foo": JointTolerances(goal_time=1.0)}
    assert updated_tolerances(defaults, [], [], goal_time)["foo"].goal_time == after


@pytest.mark.parametrize("what", ["position", "velocity", "acceleration"])
def test_each_quantity_has_its_own_bound(what):
    bound = StateTolerances(**{what: 1.0})
    others = {"position": -2.0, "velocity": -2.0, "acceleration": -2.0}
    assert bound.violation(**(others | {what: -1.0})) is None
    assert bound.violation(**(others | {what: -2.0})) == (what, -2.0, 1.0)


def test_requests_for_other_joints_change_nothing():
    requests = [ToleranceRequest("knee", position=0.1)]
    assert updated_tolerances(DEFAULTS, requests, requests, 0.0) == DEFAULTS


@pytest.mark.parametrize(
    ("errors", "violation"),
    [
        ((0.1, 0.2, 0.3), None),
        ((-0.11, 0.0, 0.0), ("position", -0.11, 0.1)),
        ((0.0, 0.21, 0.0), ("velocity", 0.21, 0.2)),
        ((0.0, 0.0, 0.31), ("acceleration", 0.31, 0.3)),
    ],
)
def test_a_violation_is_named(errors, violation):
    assert StateTolerances(0.1, 0.2, 0.3).violation(*errors) == violation


def test_a_bound_of_zero_is_none():
    assert StateTolerances().violation(1e9, 1e9, 1e9) is None
