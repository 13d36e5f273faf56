"""Reading the action's goal from JSON-compatible values."""

import pytest

from station.controllers.joint_trajectory_controller.goals import (
    parse_goal,
)
from station.core.errors import InvalidTrajectoryError
from station.core.trajectory import JointTrajectoryPoint, ToleranceRequest

POINT = {"positions": [1, 2.0], "velocities": [0.1, 0.2], "time_from_start": 1}


def _request(**trajectory):
    return {"trajectory": {"joint_names": ["a", "b"], "points": [POINT]} | trajectory}


def test_all_fields_are_read():
    goal = parse_goal(
        _request(stamp=3.5)
        | {
            "path_tolerance": [{"name": "a", "position": 0.1}],
            "goal_tolerance": [{"name": "b", "velocity": -1}],
            "goal_time_tolerance": 0.5,
        }
    )
    assert goal.trajectory.joint_names == ["a", "b"]
    assert goal.trajectory.stamp == 3.5
    assert goal.trajectory.points == [
        JointTrajectoryPoint([1.0, 2.0], [0.1, 0.2], [], 1.0)
    ]
    assert goal.path_tolerance == (ToleranceRequest("a", position=0.1),)
    assert goal.goal_tolerance == (ToleranceRequest("b", velocity=-1.0),)
    assert goal.goal_time_tolerance == 0.5


def test_the_stamp_may_stand_in_the_header():
    assert parse_goal(_request(header={"stamp": 2.5})).trajectory.stamp == 2.5


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({}, "'trajectory' is None; it must be a mapping"),
        ({"trajectory": []}, r"'trajectory' is \[\]"),
        (_request(joint_names=None), "'trajectory/joint_names' is None"),
        (_request(joint_names="ab"), "'trajectory/joint_names' is 'ab'"),
        (_request(joint_names=[1]), "'trajectory/joint_names'"),
        (_request(points={}), "'trajectory/points' is {}; it must be a list"),
        (_request(points=[3]), "'trajectory/points/0' is 3"),
        (_request(points=[{"positions": ["x"]}]), "'trajectory/points/0/positions'"),
        (_request(points=[{"positions": 1.0}]), "'trajectory/points/0/positions'"),
        (_request(points=[{"time_from_start": "1"}]), "points/0/time_from_start"),
        (_request(points=[{"position": [1.0]}]), r"\['position'\]; it must be made of"),
        (_request(stamp=True), "'trajectory/stamp' is True; it must be a number"),
        (_request() | {"path_tolerance": [{}]}, "'path_tolerance/0/name' is None"),
        (
            _request() | {"goal_tolerance": [{"name": "a", "position": float("nan")}]},
            "'goal_tolerance/0/position' is nan; it must be a finite number",
        ),
        (_request() | {"goal_time_tolerance": float("inf")}, "finite number"),
        (_request() | {"goal_time_tolerance": 1e300}, "at most 86400 s"),
        (_request() | {"tolerance": 1}, r"'the goal' is \['tolerance'\]"),
    ],
)
def test_what_is_missing_unknown_or_of_a_wrong_type_is_refused(request_, message):
    with pytest.raises(InvalidTrajectoryError, match=message):
        parse_goal(request_)
