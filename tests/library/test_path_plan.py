"""The plan of a path: its times, the joints it leaves alone, and limits."""

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.hardware.limits import JointLimits
from station.library.waypoint_paths import plan_path
from station.reports import Waypoint, WaypointPath

PATH = WaypointPath(
    "wave",
    "",
    (
        Waypoint("a", 2.0, {"j1": 0.0}),
        Waypoint("b", 4.0, {"j1": 1.0, "other": 9.0}),
        Waypoint("c", 2.0, {"j2": 0.5}),
    ),
)
JOINTS = ["j1", "j2"]


def test_twice_the_speed_is_half_the_time():
    assert plan_path(PATH, 0, JOINTS, [0.0, 0.0], 1.0).times == [2.0, 6.0, 8.0]
    assert plan_path(PATH, 0, JOINTS, [0.0, 0.0], 2.0).times == [1.0, 3.0, 4.0]


def test_joints_that_a_waypoint_does_not_name_stay():
    points = plan_path(PATH, 0, JOINTS, [0.0, 0.1], 1.0).goal()["trajectory"]["points"]
    assert [p["positions"] for p in points] == [[0.0, 0.1], [1.0, 0.1], [1.0, 0.5]]


def test_in_the_middle_of_a_way_its_rest_takes_the_rest_of_its_time():
    """At 0.75 of the way from a to b, a quarter of the 4 s is left."""
    assert plan_path(PATH, 1, JOINTS, [0.75, 0.0], 1.0, {"j1": 0.0}).times == [1.0, 3.0]


def test_a_speed_beyond_the_limit_is_refused_with_the_time_it_needs():
    """The mean speed of 0.25 rad/s has its peak at 15/8 of it, 0.469 rad/s."""
    plan = plan_path(PATH, 0, JOINTS, [0.0, 0.0], 1.0)
    plan.check({"j1": JointLimits(max_velocity=0.47)})
    with pytest.raises(InvalidTrajectoryError, match=r"limit is 0\.46") as caught:
        plan.check({"j1": JointLimits(max_velocity=0.46)})
    assert "4.2 s or more" in caught.value.remedy


def test_a_waypoint_out_of_a_joints_range_is_refused():
    plan = plan_path(PATH, 0, JOINTS, [0.0, 0.0], 1.0)
    with pytest.raises(InvalidTrajectoryError, match=r"allowed are -0\.9 to 0\.9"):
        plan.check({"j1": JointLimits(min_position=-0.9, max_position=0.9)})
