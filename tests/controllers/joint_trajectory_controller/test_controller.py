"""The behaviours of the original's tests on a position-controlled robot."""

from math import pi

import pytest

from station.controllers.joint_trajectory_controller import (
    PositionJointTrajectoryController,
)
from station.core.errors import (
    ControllerStateError,
    InvalidTrajectoryError,
    ParameterError,
    RobotDescriptionError,
)
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import GoalStatus

JOINTS = ["slide", "elbow", "wheel"]
HOME = (1.0, [0.0, 0.0, 0.0])
AWAY = (1.0, [0.1, 0.5, -0.5])


def _trajectory(*points, joints=JOINTS, stamp=0.0):
    messages = [
        {"time_from_start": point[0], "positions": point[1]} for point in points
    ]
    return {"joint_names": joints, "points": messages, "stamp": stamp}


def test_starting_holds_the_position(robot, start):
    robot.position[:] = [0.2, 1.0, 9.0]
    controller = start()
    robot.run_with_position(controller, 100)
    assert robot.position == [0.2, 1.0, 9.0]


def test_a_goal_is_reached(robot, start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal((0.5, [0.1, 0.2, 0.3]), AWAY))
    robot.run_with_position(controller, 500)
    assert goal.status is GoalStatus.ACTIVE
    assert goal.progress == pytest.approx(0.5, abs=0.002)
    assert robot.position == pytest.approx([0.1, 0.2, 0.3], abs=1e-3)
    robot.run_with_position(controller, 502)
    assert goal.status is GoalStatus.SUCCEEDED
    assert goal.progress == 1.0
    assert goal.result.code == 0
    assert robot.position == pytest.approx(AWAY[1], abs=1e-12)


def test_a_goal_is_planned_from_one_cycle_alone(robot, start, make_goal, monkeypatch):
    controller = start()
    controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    execution, ticket = controller.execution, CommandTicket(lambda: 0)
    planner = controller.planner
    look = planner._places

    def look_while_a_cycle_passes():
        monkeypatch.setattr(planner, "_places", look)
        robot.run_with_position(controller)
        return look()

    monkeypatch.setattr(planner, "_places", look_while_a_cycle_passes)
    before = execution.moment
    controller.goals.submit(make_goal(HOME), ticket)

    assert execution.moment != before
    assert ticket.planned_at == execution.moment[0]


def test_a_trajectory_without_a_goal_is_followed(robot, start):
    controller = start()
    controller.trajectories.follow_trajectory(_trajectory(AWAY))
    robot.run_with_position(controller, 1002)
    assert robot.position == pytest.approx(AWAY[1], abs=1e-12)


def test_joints_may_be_named_in_any_order(robot, start, make_goal):
    controller = start()
    order = ["wheel", "slide", "elbow"]
    controller.goals.submit(make_goal((1.0, [0.3, 0.1, 0.2]), joints=order))
    robot.run_with_position(controller, 1002)
    assert robot.position == pytest.approx([0.1, 0.2, 0.3], abs=1e-12)


@pytest.mark.parametrize(
    ("start_at", "goal", "end_at"),
    [(4.0, -2.0, 2 * pi - 2.0), (0.0, 2 * pi + 0.5, 2 * pi + 0.5), (0.0, pi, pi)],
)
def test_a_continuous_joint_goes_the_short_way(
    robot, start, make_goal, start_at, goal, end_at
):
    robot.position[2] = start_at
    controller = start()
    controller.goals.submit(make_goal((1.0, [0.0, 0.0, goal])))
    robot.run_with_position(controller, 1002)
    assert robot.position[2] == pytest.approx(end_at, abs=1e-12)


def test_a_goal_replaces_a_goal_without_a_jump(robot, start, make_goal):
    controller = start()
    first = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    second = controller.goals.submit(make_goal(HOME))
    before = list(robot.position)
    robot.run_with_position(controller, 1)
    assert first.status is GoalStatus.PREEMPTED
    assert second.status is GoalStatus.ACTIVE
    assert robot.position == pytest.approx(before, abs=1e-3)
    robot.run_with_position(controller, 1002)
    assert second.status is GoalStatus.SUCCEEDED
    assert robot.position == pytest.approx(HOME[1], abs=1e-12)


def test_a_trajectory_without_a_goal_preempts_a_goal(robot, start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    controller.trajectories.follow_trajectory(_trajectory(HOME))
    robot.run_with_position(controller, 1002)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.position == pytest.approx(HOME[1], abs=1e-12)


def test_a_trajectory_that_starts_later_leaves_the_present_one_until_then(
    robot, start, make_goal
):
    controller = start()
    controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 100)
    controller.goals.submit(make_goal(HOME, stamp=robot.time + 0.4))
    robot.run_with_position(controller, 390)
    assert robot.position[1] == pytest.approx(0.49 * 0.5, abs=1e-3)
    robot.run_with_position(controller, 1020)
    assert robot.position == pytest.approx(HOME[1], abs=1e-12)


def test_two_requests_between_two_cycles_are_both_taken_up(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 1)
    first = controller.goals.submit(make_goal(AWAY))
    second = controller.goals.submit(make_goal(HOME))
    robot.run_with_position(controller, 1)
    assert first.status is GoalStatus.PREEMPTED
    assert second.status is GoalStatus.ACTIVE


def test_an_empty_trajectory_stops_and_holds(robot, start):
    controller = start()
    controller.trajectories.follow_trajectory(_trajectory(AWAY))
    robot.run_with_position(controller, 500)
    here = list(robot.position)
    controller.trajectories.follow_trajectory(_trajectory())
    robot.run_with_position(controller, 600)
    assert robot.position == pytest.approx(here, abs=1e-12)


def test_an_empty_goal_preempts_and_succeeds_at_rest(robot, start, make_goal):
    controller = start()
    first = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    second = controller.goals.submit(make_goal())
    robot.run_with_position(controller, 2)
    assert first.status is GoalStatus.PREEMPTED
    assert second.status is GoalStatus.SUCCEEDED


def test_a_stop_duration_lets_the_motion_die_away(robot, start, make_goal):
    controller = start(stop_trajectory_duration=0.5)
    controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    speed, here = robot.velocity[1], robot.position[1]
    goal = controller.goals.submit(make_goal())
    robot.run_with_position(controller, 250)
    assert 0.0 < robot.velocity[1] < speed
    assert goal.status is GoalStatus.ACTIVE
    robot.run_with_position(controller, 300)
    assert robot.velocity[1] == pytest.approx(0.0, abs=1e-9)
    assert robot.position[1] == pytest.approx(here + 5 / 16 * speed, abs=1e-3)
    assert goal.status is GoalStatus.SUCCEEDED


def _braking(**decelerations):
    each = {
        name: {"max_deceleration_on_cancel": deceleration}
        for name, deceleration in decelerations.items()
    }
    return {"constraints": {"decelerate_on_cancel": True, **each}}


@pytest.mark.parametrize("speed", [1.0, 0.5])
def test_each_joint_of_a_cancelled_goal_brakes_by_itself(
    robot, start, make_goal, speed
):
    # As decelerate_to_hold_position of ros2_controllers: v / a long, v^2 / (2 a) far.
    decelerations = [2.0, 3.0, 0.8]
    controller = start(
        **_braking(**dict(zip(JOINTS, decelerations, strict=True))),
        speed_scaling=speed,
    )
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    began = list(zip(robot.position, robot.velocity, decelerations, strict=True))
    controller.goals.cancel(goal.identifier)
    longest = max(abs(v) / a for _, v, a in began)
    robot.run_with_position(controller, int(1000 * longest) - 20)
    assert abs(robot.velocity[2]) == pytest.approx(0.02 * 0.8, abs=2e-3)
    assert robot.velocity[:2] == pytest.approx([0.0, 0.0], abs=1e-9)
    robot.run_with_position(controller, 40)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.velocity == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    rest = [q + v * abs(v) / (2.0 * a) for q, v, a in began]
    assert robot.position == pytest.approx(rest, abs=2e-3)


def test_joints_hold_at_once_if_one_has_no_deceleration(
    robot, start, make_goal, caplog
):
    controller = start(**_braking(slide=2.0))
    assert "not every joint has a max_deceleration_on_cancel" in caplog.text
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    here = list(robot.position)
    controller.goals.cancel(goal.identifier)
    robot.run_with_position(controller, 100)
    assert robot.position == pytest.approx(here, abs=1e-12)


def test_a_cancelled_goal_ends_and_the_joints_hold(robot, start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    here = list(robot.position)
    controller.goals.cancel(goal.identifier)
    robot.run_with_position(controller, 600)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.position == pytest.approx(here, abs=1e-12)


def test_stopping_the_controller_ends_the_goal_for_good(robot, start, make_goal):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 500)
    waiting = controller.goals.submit(make_goal(HOME))
    here = list(robot.position)
    controller.stop_request(robot.time)
    assert goal.status is waiting.status is GoalStatus.PREEMPTED
    robot.time += 5.0
    controller.start_request(robot.time)
    robot.run_with_position(controller, 600)
    assert robot.position == pytest.approx(here, abs=1e-12)


def test_a_failing_controller_aborts_its_goals(robot, start, make_goal):
    controller = start()
    active = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 10)
    waiting = controller.goals.submit(make_goal(HOME))
    controller.abort_request(robot.time)
    assert active.status is waiting.status is GoalStatus.ABORTED
    assert active.result.message == "The controller failed."


def test_a_goal_that_came_too_late_does_not_survive_a_restart(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 10)
    goal = controller.goals.submit(make_goal(AWAY))
    controller.start_request(robot.time)
    robot.run_with_position(controller, 10)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.position == [0.0, 0.0, 0.0]


def test_a_partial_goal_moves_its_joints_only(robot, start, make_goal):
    robot.position[:] = [0.2, 0.4, 0.6]
    controller = start(allow_partial_joints_goal=True)
    goal = controller.goals.submit(make_goal((1.0, [-0.5]), joints=["elbow"]))
    robot.run_with_position(controller, 1002)
    assert goal.status is GoalStatus.SUCCEEDED
    assert robot.position == pytest.approx([0.2, -0.5, 0.6], abs=1e-12)


def test_partial_goals_are_refused_by_default(start, make_goal):
    controller = start()
    with pytest.raises(InvalidTrajectoryError, match="expected are slide, elbow"):
        controller.goals.submit(make_goal((1.0, [-0.5]), joints=["elbow"]))


@pytest.mark.parametrize(
    ("points", "fields", "message"),
    [
        ([(1.0, [0.0, 0.0])], {}, "2 positions for 3 joints"),
        ([(1.0, [0.0, 0.0, float("nan")])], {}, "nan among its positions"),
        ([(1.0, [0.0, 0.0, float("inf")])], {}, "inf among its positions"),
        ([HOME, HOME], {}, "Point 1 is due 1 s after the start, not later"),
        ([(2.0, HOME[1]), HOME], {}, "Point 1 is due 1 s after"),
        ([(0.0, HOME[1])], {}, r"'slide' is 0\.0098.* away .* due at once"),
        ([(-0.1, HOME[1]), HOME], {}, r"Point 0 has the time_from_start -0\.1 s"),
        ([HOME], {"stamp": 50.0}, r"in the past, the last one by 49\."),
        ([HOME], {"joints": ["slide", "elbow", "knee"]}, "expected are slide, elbow"),
        ([HOME], {"joints": ["slide", "elbow", "elbow"]}, "expected are slide, elbow"),
        ([(1.0, [0.6, 0.0, 0.0])], {}, r"position 0\.6 for 'slide'; allowed is -0\.5"),
        ([(1.0, HOME[1], [0.0])], {}, "1 velocities for 3 joints"),
    ],
)
def test_a_malformed_goal_is_refused_and_changes_nothing(
    robot, start, make_goal, points, fields, message
):
    controller = start()
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 100)
    with pytest.raises(InvalidTrajectoryError, match=message):
        controller.goals.submit(make_goal(*points, **fields))
    robot.run_with_position(controller, 902)
    assert goal.status is GoalStatus.SUCCEEDED
    assert controller.goals.goals() == [goal]


def test_points_in_the_past_are_dropped(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 1)
    points = ((0.9, [0.4, 2.0, 2.0]), (2.0, AWAY[1]))
    goal = controller.goals.submit(make_goal(*points, stamp=robot.time - 1.0))
    robot.run_with_position(controller, 500)
    assert robot.position == pytest.approx([0.05, 0.25, -0.25], abs=1e-3)
    robot.run_with_position(controller, 502)
    assert goal.status is GoalStatus.SUCCEEDED


def test_a_goal_where_the_joints_are_is_reached_at_once(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 5)
    goal = controller.goals.submit(make_goal((0.0, [0.0, 0.00005, 0.0])))
    robot.run_with_position(controller, 1)
    assert goal.status is GoalStatus.SUCCEEDED
    assert robot.position == HOME[1]


def test_a_moving_joint_keeps_its_velocity_when_a_point_without_one_comes(
    robot, start, make_goal
):
    controller = start()
    still = [0.0, 0.0, 0.0]
    controller.goals.submit(make_goal((1.0, [0.2, 0.8, 1.0], still)))
    robot.run_with_position(controller, 500)
    velocity = list(robot.velocity)
    controller.goals.submit(make_goal((1.0, still), (2.0, [0.1, 0.2, 0.3])))
    robot.run_with_position(controller, 2)
    assert robot.velocity == pytest.approx(velocity, abs=0.02)
    robot.run_with_position(controller, 997)
    assert robot.velocity == pytest.approx([0.1, 0.2, 0.3], abs=0.02)


def test_without_room_to_turn_a_moving_joint_goes_on_along_a_line(
    robot, start, make_goal
):
    controller = start()
    still = [0.0, 0.0, 0.0]
    controller.goals.submit(make_goal((1.0, [0.5, 0.0, 0.0], still)))
    robot.run_with_position(controller, 700)
    goal = controller.goals.submit(make_goal((1.0, [0.45, 0.0, 0.0])))
    robot.run_with_position(controller, 1002)
    assert goal.status is GoalStatus.SUCCEEDED
    assert max(robot.position) < 0.5


def test_goals_need_a_running_controller(robot, start, make_goal):
    controller = start()
    controller.stop_request(robot.time)
    with pytest.raises(ControllerStateError, match="not running"):
        controller.goals.submit(make_goal(AWAY))
    with pytest.raises(ControllerStateError, match="not running"):
        controller.trajectories.follow_trajectory(_trajectory(AWAY))
    with pytest.raises(ControllerStateError, match="not running"):
        controller.trajectories.query_state(robot.time)


def test_the_state_is_consistent(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 1)
    controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 300, stuck=[0])
    state, sample = controller.trajectory_state, controller.sample
    assert state.stamp == sample.stamp == robot.time
    assert state.desired.velocity == pytest.approx([0.1, 0.5, -0.5])
    for desired, actual, error in (
        (state.desired.position, state.actual.position, state.error.position),
        (state.desired.velocity, state.actual.velocity, state.error.velocity),
        (sample.desired, sample.actual, sample.error),
    ):
        differences = [d - a for d, a in zip(desired, actual, strict=True)]
        assert error == pytest.approx(differences, abs=1e-12)


def test_speed_scaling_slows_down_and_pauses_on_the_same_path(robot, start, make_goal):
    controller = start(speed_scaling=0.5, speed_scaling_ramp=0.1)
    robot.run_with_position(controller, 1)
    goal = controller.goals.submit(make_goal(AWAY))
    robot.run_with_position(controller, 1000)
    assert robot.position[1] == pytest.approx(0.25, abs=1e-3)
    assert controller.execution.tracking.velocities[1] == pytest.approx(0.25, abs=1e-6)
    controller.tunables.apply(controller.tunables.values | {"speed_scaling": 0.0})
    robot.run_with_position(controller, 200)
    paused = list(robot.position)
    robot.run_with_position(controller, 1000)
    assert robot.position == paused
    assert goal.status is GoalStatus.ACTIVE
    controller.tunables.apply(controller.tunables.values | {"speed_scaling": 1.0})
    robot.run_with_position(controller, 700)
    assert goal.status is GoalStatus.SUCCEEDED


@pytest.mark.parametrize(
    "values",
    [
        {"joints": []},
        {"stop_trajectory_duration": -1.0},
        {"speed_scaling": 2.0},
        {"speed_scaling_ramp": -1.0},
        {"allow_partial_joints_goal": "maybe"},
        {"constraints": {"goal_time": "soon"}},
    ],
)
def test_impossible_parameters_are_refused(start, values):
    with pytest.raises(ParameterError, match="arm/"):
        start(**values)


def test_a_trajectory_controller_needs_a_robot_description(make_robot):
    with pytest.raises(RobotDescriptionError):
        make_robot(urdf="").load(PositionJointTrajectoryController, joints=JOINTS)
