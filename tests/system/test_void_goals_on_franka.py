"""A goal of the simulated arm that was ended from outside never goes on by itself."""

import pytest

from station.client import ApiError
from station.wire import Fault
from tests.system.arm_bench import ARM, ArmBench

pytestmark = pytest.mark.long

POSITION_ARM = "position_joint_trajectory_controller"
TURN = 0.8
ARMS = [ARM, POSITION_ARM]


@pytest.fixture
def bench(tmp_path):
    bench = ArmBench(tmp_path)
    yield bench
    bench.close()


@pytest.fixture(params=ARMS)
def moving(request, bench):
    """Return the bench in the middle of a motion, its controller and its goal."""
    bench.start(request.param)
    goal = bench.send(bench.turned(TURN), name=request.param, pace=2.0)
    bench.run(0.8)
    assert bench.goal(goal, request.param).status == "active"
    return bench, request.param, goal


def assert_nothing_resumes(bench, name, goal, statuses):
    """Check that the goal has ended, and that the arm stays for longer than it had."""
    bench.run(0.3)
    held = bench.positions()
    bench.run(2.5)
    assert bench.positions() == pytest.approx(held, abs=2e-3)
    assert bench.goal(goal, name).status in statuses
    assert bench.goal(goal, name).result.message


def assert_a_new_goal_is_reached(bench, name):
    wanted = bench.turned(-0.2)
    done = bench.finish(bench.send(wanted, name=name), name)
    assert done.status == "succeeded"
    assert bench.positions() == pytest.approx(wanted, abs=5e-3)


def test_a_stop_and_its_release(moving):
    bench, name, goal = moving
    epoch = bench.client.status().epoch
    bench.client.stop("test")
    bench.run(0.3)
    assert bench.goal(goal, name).status == "preempted"
    assert "The station was stopped: " in bench.goal(goal, name).result.message
    with pytest.raises(ApiError) as caught:
        bench.send(bench.turned(TURN), name=name)
    assert caught.value.status == 423
    bench.client.release_stop()
    bench.client.release_stop(arm=True)
    bench.start(name)
    assert_nothing_resumes(bench, name, goal, {"preempted"})
    with pytest.raises(ApiError) as caught:
        bench.client.submit_goal(name, {"trajectory": {}}, epoch=epoch)
    assert caught.value.code == "stale_epoch"
    assert_a_new_goal_is_reached(bench, name)


def test_the_user_stop_and_a_recovery(moving):
    bench, name, goal = moving
    robot = bench.client.robot("panda")
    robot.user_stop(pressed=True)
    bench.run(0.3)
    done = bench.goal(goal, name)
    assert done.status == "preempted"
    assert done.result.message == "The user stop of arm 'panda' was pressed."
    robot.user_stop(pressed=False)
    bench.run(0.1)
    # There was no error, so there is nothing to recover and nothing to start again.
    assert robot.recover("previous").restarted == []
    bench.start(name)
    assert_nothing_resumes(bench, name, goal, {"preempted"})
    assert_a_new_goal_is_reached(bench, name)


def test_a_reflex_and_a_recovery_that_restarts_the_controller(moving):
    bench, name, goal = moving
    robot = bench.client.robot("panda")
    robot.inject(Fault(kind="collision", cycles=30))
    bench.run(0.3)
    done = bench.goal(goal, name)
    assert done.status == "aborted"
    assert "reflex" in done.result.message
    bench.run(0.5)
    recovery = robot.recover("previous")
    assert recovery.restarted == [name]
    assert_nothing_resumes(bench, name, goal, {"aborted"})
    assert_a_new_goal_is_reached(bench, name)


def test_a_controller_that_is_stopped_and_started(moving):
    bench, name, goal = moving
    bench.client.switch_controllers(stop=[name])
    bench.run(0.1)
    assert bench.goal(goal, name).status == "preempted"
    bench.start(name)
    assert_nothing_resumes(bench, name, goal, {"preempted"})
    assert_a_new_goal_is_reached(bench, name)


def test_a_reset_of_the_simulated_world(moving):
    bench, name, goal = moving
    bench.client.simulation.reset()
    bench.run(0.1)
    assert bench.goal(goal, name).status == "preempted"
    assert "A reset put the simulated world" in bench.goal(goal, name).result.message
    assert bench.client.controller(name).state == "running"
    assert_nothing_resumes(bench, name, goal, {"preempted"})
    assert_a_new_goal_is_reached(bench, name)
