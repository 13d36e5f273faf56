"""Joining a request to what is being executed: the original's recorded answers.

Holding and coming to rest.
"""

from math import pi

import pytest

from station.core.errors import InvalidTrajectoryError
from station.core.ports.goal import Goal
from station.core.trajectory import (
    JointTolerances,
    JointTrajectory,
    JointTrajectoryPoint,
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
    StateTolerances,
    TrajectoryOptions,
    braking_trajectory,
    find_segment,
    hold_trajectory,
    init_joint_trajectory,
    sample_segments,
    stop_trajectory,
)

REASONS = {
    "Trajectory message contains empty": "empty",
    "Trajectory message contains waypoints": "order",
    "Cannot create trajectory from message. It does": "joints",
    "Cannot create trajectory from message. Vector": "wraparound",
    "Dropping all": "past",
}
# Bridges start at sampled states: their arithmetic is the same, so is every bit.
TOLERANCE = 1e-12


def _request(recorded):
    points = [
        JointTrajectoryPoint(
            point["positions"],
            point["velocities"],
            point["accelerations"],
            point["time_from_start"],
        )
        for point in recorded["points"]
    ]
    return JointTrajectory(recorded["joint_names"], points, recorded["stamp"])


def _segment(recorded):
    states = [
        PosVelAccState(each["position"], each["velocity"], each["acceleration"])
        for each in (recorded["start_state"], recorded["end_state"])
    ]
    spline = QuinticSplineSegment(
        recorded["start_time"], states[0], recorded["end_time"], states[1]
    )
    return JointTrajectorySegment(spline, states[1])


def _options(recorded):
    current = recorded["current_trajectory"]
    return TrajectoryOptions(
        current=current and [[_segment(each) for each in joint] for joint in current],
        joint_names=recorded["joint_names"],
        angle_wraparound=recorded["angle_wraparound"],
        other_time_base=recorded["other_time_base"],
        allow_partial_joints_goal=recorded["allow_partial_joints_goal"],
    )


def _agrees(recorded):
    result = init_joint_trajectory(
        _request(recorded["msg"]), recorded["time"], _options(recorded["options"])
    )
    times = [
        [{"start_time": s.start_time, "end_time": s.end_time} for s in joint]
        for joint in result
    ]
    assert times == recorded["result_segments"]
    for sample in recorded["result_samples"]:
        for segments, expected in zip(result, sample["joints"], strict=True):
            index = find_segment(segments, sample["time"])
            assert (-1 if index is None else index) == expected["seg_index"]
            state = [
                expected["state"][key][0]
                for key in ("position", "velocity", "acceleration")
            ]
            assert sample_segments(segments, sample["time"]) == pytest.approx(
                tuple(state), rel=TOLERANCE, abs=TOLERANCE
            )


def _is_refused(recorded):
    with pytest.raises(InvalidTrajectoryError) as caught:
        init_joint_trajectory(
            _request(recorded["msg"]), recorded["time"], _options(recorded["options"])
        )
    (reason,) = [
        reason
        for beginning, reason in REASONS.items()
        if recorded["error_string"].startswith(beginning)
    ]
    assert caught.value.details["reason"] == reason
    if reason == "past":
        late = recorded["error_string"].split()[-4].removesuffix("s")
        assert f"by {late} s" in caught.value.message


def test_all_recorded_cases_agree(vectors):
    cases = vectors["init_joint_trajectory"]
    accepted = [case for case in cases if not case["error_string"]]
    assert len(accepted) >= 50
    for case in accepted:
        _agrees(case)


def test_all_recorded_refusals_agree(vectors):
    cases = vectors["init_joint_trajectory"]
    refused = [case for case in cases if case["error_string"]]
    assert len(refused) >= 20
    for case in refused:
        _is_refused(case)


def _points(*positions):
    return [
        JointTrajectoryPoint([position], time_from_start=1.0 + index)
        for index, position in enumerate(positions)
    ]


@pytest.mark.parametrize(
    ("point", "message"),
    [
        (JointTrajectoryPoint([1.0, 2.0]), "2 positions for 1 joint"),
        (JointTrajectoryPoint([]), "0 positions for 1 joint"),
        (JointTrajectoryPoint([1.0], [1.0, 1.0]), "2 velocities for 1"),
        (JointTrajectoryPoint([1.0], [], [1.0, 1.0]), "2 accelerations for 1"),
        (JointTrajectoryPoint([float("nan")]), "nan among its positions, for 'a'"),
        (JointTrajectoryPoint([1.0], [float("inf")]), "inf among its velocities"),
        (JointTrajectoryPoint([1.0], time_from_start=float("nan")), "time_from_start"),
    ],
)
def test_malformed_points_are_refused(point, message):
    with pytest.raises(InvalidTrajectoryError, match=f"Point 1 has .*{message}"):
        init_joint_trajectory(
            JointTrajectory(["a"], [*_points(0.0), point]), 10.0, TrajectoryOptions()
        )


def test_a_joint_may_be_named_once_only():
    request = JointTrajectory(["a", "a"], [JointTrajectoryPoint([1.0, 2.0])])
    with pytest.raises(InvalidTrajectoryError, match="names the joints a, a;"):
        init_joint_trajectory(
            request,
            0.0,
            TrajectoryOptions(joint_names=["a", "b"], allow_partial_joints_goal=True),
        )


def test_a_current_trajectory_that_begins_later_is_an_error():
    start, end = PosVelAccState([0.0]), PosVelAccState([1.0])
    later = JointTrajectorySegment(QuinticSplineSegment(20.0, start, 21.0, end), end)
    with pytest.raises(InvalidTrajectoryError, match="does not cover the time 10"):
        init_joint_trajectory(
            JointTrajectory(["a"], _points(0.0)),
            10.0,
            TrajectoryOptions(current=[[later]]),
        )


def _moving(start_time, velocity):
    """Return segments of 2 s for a joint that moves from 0 with that velocity."""
    start = PosVelAccState([0.0], [velocity], [0.0])
    end = PosVelAccState([2.0 * velocity], [velocity], [0.0])
    spline = QuinticSplineSegment(start_time, start, start_time + 2.0, end)
    bounds = JointTolerances(StateTolerances(0.1))
    return [JointTrajectorySegment(spline, end, goal=OLD, tolerances=bounds)]


OLD, NEW = Goal("old", {}), Goal("new", {})


def test_a_joint_that_is_left_out_goes_on_under_the_new_goal_with_its_bounds():
    current = [_moving(10.0, 0.5), _moving(10.0, 0.25)]
    bounds = {"b": JointTolerances(StateTolerances(0.3))}
    result = init_joint_trajectory(
        JointTrajectory(["b"], _points(1.0)),
        11.0,
        TrajectoryOptions(
            current=current,
            joint_names=["a", "b"],
            allow_partial_joints_goal=True,
            goal=NEW,
            tolerances=bounds,
        ),
    )
    (kept,) = result[0]
    assert kept.goal is NEW
    assert kept.tolerances.path.position == 0.1
    assert kept.spline is current[0][0].spline
    before, bridge = result[1]
    assert before.tolerances.path.position == 0.1
    assert bridge.goal is NEW
    assert bridge.tolerances.path.position == 0.3


def test_a_point_without_velocities_is_gone_to_on_a_line_from_a_moving_joint():
    result = init_joint_trajectory(
        JointTrajectory(["a"], _points(2.5)),
        11.0,
        TrajectoryOptions(current=[_moving(10.0, 0.5)]),
    )
    assert sample_segments(result[0], 11.5) == pytest.approx((1.5, 2.0, 0.0))


def test_whole_turns_are_added_to_every_point():
    turn = 2.0 * pi
    start, end = PosVelAccState([3 * turn]), PosVelAccState([3 * turn])
    hold = JointTrajectorySegment(QuinticSplineSegment(0.0, start, 0.0, end), end)
    result = init_joint_trajectory(
        JointTrajectory(["a"], _points(0.5, 1.0, -0.5)),
        10.0,
        TrajectoryOptions(current=[[hold]], angle_wraparound=[True]),
    )
    reached = [sample_segments(result[0], 11.0 + i)[0] - 3 * turn for i in range(3)]
    assert reached == pytest.approx([0.5, 1.0, -0.5])


def test_a_start_before_the_other_time_base_began_is_no_hindrance():
    """The original's times cannot be negative, so it refuses this one."""
    points = [
        JointTrajectoryPoint([1.0], time_from_start=1.0),
        JointTrajectoryPoint([2.0], time_from_start=11.0),
    ]
    result = init_joint_trajectory(
        JointTrajectory(["a"], points, stamp=100.0),
        110.0,
        TrajectoryOptions(current=[_moving(0.0, 0.0)], other_time_base=0.5),
    )
    assert result[0][-1].end_time == pytest.approx(1.5)
    assert sample_segments(result[0], 1.5)[0] == pytest.approx(2.0)


@pytest.mark.parametrize("time", [4.0, 5.0, 5.5, 100.0])
def test_holding_is_being_there_at_rest(time):
    trajectory = hold_trajectory(5.0, [0.3, -1.0])
    assert [sample_segments(joint, time) for joint in trajectory] == [
        (0.3, 0.0, 0.0),
        (-1.0, 0.0, 0.0),
    ]


def test_stopping_begins_with_the_motion_and_ends_at_rest():
    (joint,) = stop_trajectory(5.0, 0.5, [(0.3, 2.0)])
    assert sample_segments(joint, 5.0) == (0.3, 2.0, 0.0)
    # There and back in 1 s by symmetry: the turning point of the quintic spline lies
    # 5/16 of velocity times the whole time away.
    rest = sample_segments(joint, 5.5)
    assert rest[0] == pytest.approx(0.3 + 5 / 16 * 2.0 * 1.0)
    assert rest[1] == pytest.approx(0.0, abs=1e-12)
    assert sample_segments(joint, 6.0)[1:] == (0.0, 0.0)


def test_stopping_never_reverses():
    (joint,) = stop_trajectory(0.0, 0.5, [(0.0, -1.5)])
    velocities = [sample_segments(joint, 0.01 * step)[1] for step in range(51)]
    assert all(velocity <= 1e-12 for velocity in velocities)


def test_each_joint_brakes_with_its_own_deceleration():
    states = [(0.3, 1.0), (0.0, -0.5), (0.1, 0.0)]
    moving, back, resting = braking_trajectory(5.0, [2.0, 5.0, 1.0], states)
    for time in (0.0, 0.2, 0.4):
        state = sample_segments(moving, 5.0 + time)
        assert state == pytest.approx((0.3 + time - time**2, 1.0 - 2.0 * time, -2.0))
    assert sample_segments(moving, 5.6) == pytest.approx((0.55, 0.0, 0.0))
    assert sample_segments(back, 5.05)[1:] == pytest.approx((-0.25, 5.0))
    assert sample_segments(back, 5.2) == pytest.approx((-0.025, 0.0, 0.0))
    assert sample_segments(resting, 5.0) == (0.1, 0.0, 0.0)


def test_a_goal_can_wait_for_it():
    goal = Goal("1", {})
    assert hold_trajectory(0.0, [0.0], goal)[0][0].goal is goal
    assert stop_trajectory(0.0, 1.0, [(0.0, 1.0)], goal)[0][0].goal is goal
