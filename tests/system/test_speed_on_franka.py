"""Pausing, slowing and cancelling goals of the simulated arm, as a client does."""

import pytest

from tests.system.arm_bench import ARM, JOINTS, ArmBench

pytestmark = pytest.mark.long

ARMS = [ARM, "position_joint_trajectory_controller"]
BOUNDS = [{"name": joint, "position": 0.05} for joint in JOINTS]


@pytest.fixture(params=ARMS)
def moving(request, tmp_path):
    """Return the bench in the middle of a motion, the controller, goal and target."""
    bench = ArmBench(tmp_path)
    bench.start(request.param)
    target = bench.turned(0.8)
    goal = bench.send(
        target,
        name=request.param,
        pace=2.0,
        path_tolerance=BOUNDS,
        goal_time_tolerance=0.5,
    )
    bench.run(0.9)
    assert bench.goal(goal, request.param).status == "active"
    yield bench, request.param, goal, target
    bench.close()


def set_speed(bench, name, speed):
    bench.client.set_gains(name, {"speed_scaling": speed})


def test_a_paused_goal_waits_and_then_arrives(moving):
    bench, name, goal, target = moving
    set_speed(bench, name, 0.0)
    bench.run(1.0)
    paused, progress = bench.positions(), bench.goal(goal, name).progress
    bench.run(4.0)
    assert bench.positions() == pytest.approx(paused, abs=2e-3)
    waiting = bench.goal(goal, name)
    assert (waiting.status, waiting.progress) == ("active", progress)
    set_speed(bench, name, 1.0)
    done = bench.finish(goal, name)
    assert done.status == "succeeded"
    bench.run(0.5)
    assert bench.positions() == pytest.approx(target, abs=2e-3)


def test_a_slow_goal_takes_longer_and_arrives(moving):
    bench, name, goal, target = moving
    set_speed(bench, name, 0.2)
    bench.run(2.0)
    assert bench.goal(goal, name).status == "active"
    assert bench.goal(goal, name).progress < 0.8
    done = bench.finish(goal, name)
    assert done.status == "succeeded"
    assert bench.positions() == pytest.approx(target, abs=5e-3)


def test_a_goal_that_replaces_a_paused_one_waits_too(moving):
    bench, name, goal, _ = moving
    set_speed(bench, name, 0.0)
    bench.run(1.0)
    target = bench.turned(-0.3)
    second = bench.send(target, name=name)
    bench.run(1.0)
    assert bench.goal(goal, name).status == "preempted"
    assert bench.goal(second, name).status == "active"
    set_speed(bench, name, 1.0)
    assert bench.finish(second, name).status == "succeeded"
    assert bench.positions() == pytest.approx(target, abs=5e-3)


def test_a_stop_during_a_pause_leaves_nothing_to_resume(moving):
    bench, name, goal, _ = moving
    set_speed(bench, name, 0.0)
    bench.run(1.0)
    bench.client.stop("test")
    bench.run(0.2)
    assert bench.goal(goal, name).status == "preempted"
    set_speed(bench, name, 1.0)
    bench.client.release_stop()
    bench.client.release_stop(arm=True)
    bench.start(name)
    held = bench.positions()
    bench.run(2.0)
    assert bench.positions() == pytest.approx(held, abs=2e-3)


def test_a_cancelled_goal_ends_without_an_error_of_the_arm(moving):
    bench, name, goal, _ = moving
    bench.client.cancel_goal(name, goal.id)
    bench.run(0.5)
    assert bench.goal(goal, name).status == "preempted"
    assert bench.client.controller(name).state == "running"
    assert bench.client.robot("panda").errors().errors == []
    held = bench.positions()
    bench.run(1.0)
    assert bench.positions() == pytest.approx(held, abs=2e-3)
    assert bench.finish(bench.send(bench.turned(-0.2), name=name), name).status == (
        "succeeded"
    )
