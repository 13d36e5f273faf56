"""Waypoint paths on disk: captured, edited, and what cannot be one."""

import math
from concurrent.futures import ThreadPoolExecutor

import pytest

from station.core import user_files
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    InvalidTrajectoryError,
    LoopError,
    WaypointPathError,
    WaypointPathNotFoundError,
)
from station.core.hardware.limits import JointLimits
from station.library.waypoint_paths import MOST_WAYPOINTS, WaypointPaths, plan_path
from station.reports import Waypoint, WaypointPath
from tests.two_joint_station import make_station
from tests.waiting import PATIENCE


@pytest.fixture
def station():
    station = make_station()
    station.loop.step()
    return station


@pytest.fixture
def paths(station, tmp_path):
    return WaypointPaths(station.loop, station.manager, tmp_path / "paths")


def test_captured_is_where_the_joints_are(station, paths):
    station.switch_controllers(SwitchRequest(start=("group",)))
    paths.capture("wave")
    station.motion.set_command("group", [0.3, -0.2])
    station.loop.step(400)
    captured = paths.capture("wave", "up", 1.5)

    assert [w.name for w in captured.waypoints] == ["point 1", "up"]
    assert captured.waypoints[0].positions == pytest.approx({"j1": 0.0, "j2": 0.0})
    assert captured.waypoints[1].positions == pytest.approx({"j1": 0.3, "j2": -0.2})
    assert captured.waypoints[1].duration == 1.5
    assert paths.get("wave") == captured


def test_a_captured_waypoint_has_a_free_name(paths):
    paths.save("wave", [Waypoint("point 2", 1.0, {"j1": 0.1})])
    assert paths.capture("wave").waypoints[1].name == "point 3"


def test_nothing_is_captured_before_the_first_cycle(tmp_path):
    station = make_station()
    with pytest.raises(LoopError):
        WaypointPaths(station.loop, station.manager, tmp_path).capture("wave")


def test_paths_are_listed_and_deleted(paths):
    paths.save("b", [Waypoint("x", 1.0, {"j1": 0.1})])
    paths.save("a", [])
    assert paths.names() == ["a", "b"]
    assert paths.delete("b").waypoints[0].name == "x"
    with pytest.raises(WaypointPathNotFoundError):
        paths.delete("b")
    assert paths.names() == ["a"]


@pytest.mark.parametrize(
    ("waypoint", "message"),
    [
        (Waypoint("x", 0.0, {"j1": 0.1}), "duration 0.0 s"),
        (Waypoint("x", math.nan, {"j1": 0.1}), "duration nan s"),
        (Waypoint("x", 601.0, {"j1": 0.1}), "at most 600 s"),
        (Waypoint("x", 1.0, {}), "one joint or more"),
        (Waypoint("x", 1.0, {"j1": math.inf}), "finite"),
        (Waypoint("x", 1.0, {"j3": 0.1}), "'j3', which this robot does not have"),
    ],
)
def test_what_is_no_waypoint_is_refused_and_saves_nothing(paths, waypoint, message):
    with pytest.raises(InvalidTrajectoryError, match=message):
        paths.save("wave", [waypoint])
    assert paths.names() == []


def test_a_path_has_a_bounded_number_of_waypoints(paths):
    with pytest.raises(InvalidTrajectoryError, match="allowed are 500"):
        paths.save("wave", [Waypoint("x", 1.0, {"j1": 0.0})] * (MOST_WAYPOINTS + 1))


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        "waypoints: 3",
        "waypoints: [3]",
        "waypoints: [{name: x, duration: a, positions: {j1: 0}}]",
        "waypoints: [{name: x, duration: -1, positions: {j1: 0}}]",
    ],
)
def test_a_malformed_file_is_told_with_its_place(paths, tmp_path, text):
    paths.save("wave", [])
    (tmp_path / "paths" / "wave.yaml").write_text(text)
    with pytest.raises(WaypointPathError, match=r"wave\.yaml cannot be used"):
        paths.get("wave")


def test_two_stations_that_capture_at_a_time_lose_no_waypoint(
    station, tmp_path, monkeypatch
):
    # Whoever waits is not served in order: on a busy machine one may wait for long.
    monkeypatch.setattr(user_files, "LONGEST_WAIT", PATIENCE)
    stations = [
        WaypointPaths(station.loop, station.manager, tmp_path / "paths")
        for _ in range(4)
    ]

    def capture(paths):
        for _ in range(10):
            paths.capture("wave")

    with ThreadPoolExecutor(len(stations)) as pool:
        list(pool.map(capture, stations))

    assert len(stations[0].get("wave").waypoints) == 40


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
