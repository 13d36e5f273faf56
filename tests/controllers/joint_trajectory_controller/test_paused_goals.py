"""Pause, resume and every speed between: nothing jumps, and no goal suffers from it."""

import pytest

from station.core.ports.goal import GoalStatus

PERIOD = 0.001
AWAY = [0.2, 1.0, 1.0]
REST = [0.0, 0.0, 0.0]
TO_AWAY = (1.0, AWAY, REST, REST)
TOLERANCES = {
    "constraints": {"goal_time": 0.5, "elbow": {"trajectory": 0.05, "goal": 0.01}}
}


def set_speed(controller, speed):
    controller.tunables.apply(controller.tunables.values | {"speed_scaling": speed})


@pytest.fixture
def started(robot, start):
    """Return a way to start a controller whose robot has a path to follow."""

    def start_controller(**values):
        controller = start(speed_scaling_ramp=0.2, **(TOLERANCES | values))
        robot.run_with_position(controller, 1)
        return controller

    return start_controller


@pytest.fixture
def pause(robot, make_goal):
    """Return a way to pause a goal half way; it gives the goal back."""

    def pause_goal(controller):
        goal = controller.goals.submit(make_goal(TO_AWAY))
        robot.run_with_position(controller, 500)
        set_speed(controller, 0.0)
        robot.run_with_position(controller, 250)
        assert controller.execution.speed.factor == 0.0
        return goal

    return pause_goal


def test_velocities_and_accelerations_stay_within_what_the_ramps_need(
    robot, started, make_goal
):
    controller = started()
    controller.goals.submit(make_goal(TO_AWAY))
    speeds = {200: 0.0, 700: 1.0, 950: 0.1, 1500: 0.6, 1900: 1.0}
    before, position = [0.0] * 3, list(robot.position)
    for cycle in range(3500):
        if cycle in speeds:
            set_speed(controller, speeds[cycle])
        robot.run_with_position(controller)
        velocity = list(robot.velocity)
        steps = [abs(b - a) for a, b in zip(before, velocity, strict=True)]
        # Peaks of the way: 1.875 rad/s, 5.8 rad/s^2; the ramps last 0.2 s.
        assert max(steps) <= (5.8 + 1.875 / 0.2) * PERIOD + 1e-9
        before = velocity
        position = list(robot.position)
    assert position == pytest.approx(AWAY, abs=1e-9)


def test_the_desired_velocity_is_the_change_of_the_desired_position(
    robot, started, make_goal
):
    controller = started()
    controller.goals.submit(make_goal(TO_AWAY))
    robot.run_with_position(controller, 300)
    set_speed(controller, 0.3)
    for _ in range(600):
        before = controller.execution.tracking.positions[1]
        robot.run_with_position(controller)
        change = (controller.execution.tracking.positions[1] - before) / PERIOD
        assert controller.execution.tracking.velocities[1] == pytest.approx(
            change, abs=0.01
        )


def test_a_pause_of_any_length_does_not_abort_a_goal(robot, started, pause):
    controller = started()
    goal = pause(controller)
    progress, position = goal.progress, list(robot.position)
    robot.run_with_position(controller, 20_000)
    assert goal.status is GoalStatus.ACTIVE
    assert goal.progress == progress
    assert robot.position == position
    set_speed(controller, 1.0)
    robot.run_with_position(controller, 800)
    assert goal.status is GoalStatus.SUCCEEDED


def test_the_goal_time_passes_with_the_time_of_the_trajectory(
    robot, started, make_goal
):
    controller = started()
    any_path = [{"name": "elbow", "position": -1.0}]
    goal = controller.goals.submit(make_goal(TO_AWAY, path_tolerance=any_path))
    robot.run_with_position(controller, 1100, stuck=[1])
    set_speed(controller, 0.0)
    robot.run_with_position(controller, 5000, stuck=[1])
    assert goal.status is GoalStatus.ACTIVE
    set_speed(controller, 0.5)
    robot.run_with_position(controller, 500, stuck=[1])
    assert goal.status is GoalStatus.ACTIVE
    robot.run_with_position(controller, 300, stuck=[1])
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.code == -5


def test_an_error_on_the_path_aborts_a_paused_goal_all_the_same(robot, started, pause):
    controller = started()
    goal = pause(controller)
    robot.position[1] += 0.06
    robot.run_with_position(controller, 1, stuck=[1])
    assert goal.status is GoalStatus.ABORTED
    assert goal.result.details["joint"] == "elbow"


def test_a_goal_that_replaces_a_paused_one_waits_for_the_resume(
    robot, started, pause, make_goal
):
    controller = started()
    goal = pause(controller)
    second = controller.goals.submit(make_goal((1.0, REST, REST, REST)))
    here = list(robot.position)
    robot.run_with_position(controller, 2000)
    assert goal.status is GoalStatus.PREEMPTED
    assert second.status is GoalStatus.ACTIVE
    assert second.progress == 0.0
    assert robot.position == pytest.approx(here, abs=1e-9)
    set_speed(controller, 1.0)
    robot.run_with_position(controller, 1150)
    assert second.status is GoalStatus.SUCCEEDED
    assert robot.position == pytest.approx(REST, abs=1e-9)


@pytest.mark.parametrize("stop_duration", [0.0, 0.4])
def test_a_paused_goal_that_is_cancelled_leaves_nothing_to_resume(
    robot, started, pause, stop_duration
):
    controller = started(stop_trajectory_duration=stop_duration)
    goal = pause(controller)
    controller.goals.cancel(goal.identifier)
    robot.run_with_position(controller, 2)
    assert goal.status is GoalStatus.PREEMPTED
    here = list(robot.position)
    set_speed(controller, 1.0)
    robot.run_with_position(controller, 2000)
    assert robot.position == pytest.approx(here, abs=1e-9)


def test_a_paused_controller_that_is_stopped_and_started_leaves_nothing_to_resume(
    robot, started, pause
):
    controller = started(stop_trajectory_duration=0.4)
    goal = pause(controller)
    controller.stop_request(robot.time)
    controller.start_request(robot.time)
    here = list(robot.position)
    set_speed(controller, 1.0)
    robot.run_with_position(controller, 2000)
    assert goal.status is GoalStatus.PREEMPTED
    assert robot.position == pytest.approx(here, abs=1e-9)


@pytest.mark.parametrize("speed", [0.1, 0.5, 1.0])
def test_a_stop_ramp_takes_its_time_whatever_the_speed(
    robot, started, make_goal, speed
):
    controller = started(stop_trajectory_duration=0.4, speed_scaling=speed)
    goal = controller.goals.submit(make_goal(TO_AWAY))
    robot.run_with_position(controller, round(500 / speed))
    velocity, here = robot.velocity[1], robot.position[1]
    assert velocity == pytest.approx(1.875 * speed, rel=1e-2)
    controller.goals.cancel(goal.identifier)
    robot.run_with_position(controller, 1)
    assert robot.velocity[1] == pytest.approx(velocity, rel=1e-2)
    robot.run_with_position(controller, 402)
    assert robot.velocity[1] == pytest.approx(0.0, abs=1e-9)
    # 5/16 of what the velocity would have gone in twice the time.
    assert robot.position[1] == pytest.approx(here + 5 / 8 * 0.4 * velocity, rel=0.02)


def test_starting_slowly_takes_the_present_velocity_over(robot, started):
    robot.velocity[1] = 0.3
    controller = started(stop_trajectory_duration=0.4, speed_scaling=0.5)
    assert controller.execution.tracking.velocities[1] == pytest.approx(0.3, rel=0.02)


def test_the_desired_state_is_told_for_the_present_speed(robot, started, make_goal):
    controller = started(speed_scaling=0.5)
    controller.goals.submit(make_goal(TO_AWAY))
    robot.run_with_position(controller, 600)
    state = controller.trajectories.query_state(robot.time)
    assert state.position == list(controller.execution.tracking.positions)
    assert state.velocity == pytest.approx(
        list(controller.execution.tracking.velocities)
    )
    assert state.acceleration == pytest.approx(
        list(controller.execution.tracking.accelerations)
    )
    later = controller.trajectories.query_state(robot.time + 0.2)
    robot.run_with_position(controller, 200)
    assert later.position == pytest.approx(
        list(controller.execution.tracking.positions), abs=1e-6
    )
