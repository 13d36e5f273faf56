"""An obstacle ends a goal of the simulated arm: what is told, and the arm holds."""

import pytest

from tests.system.arm_bench import ARM, INSENSITIVE, JOINTS, WALL, ArmBench

pytestmark = pytest.mark.long

POSITION_ARM = "position_joint_trajectory_controller"
SCENE = f"scene: {{objects: [{WALL}]}}\n"
INTO_THE_WALL = 0.7
"""Turn of the first joint [rad]; the hand meets the wall on the way."""
JUST_BEHIND_IT = 0.4
BOUNDS = [{"name": joint, "position": 0.05} for joint in JOINTS]


@pytest.fixture
def bench(tmp_path):
    bench = ArmBench(tmp_path, SCENE)
    yield bench
    bench.close()


@pytest.fixture
def insensitive_bench(tmp_path):
    robot = {
        "robot_description": "example-robot-data:panda",
        "collision_config": INSENSITIVE,
        "supervisor": {"velocity_factor": 5.0},
    }
    bench = ArmBench(tmp_path, f"{SCENE}robot: {robot}\n")
    yield bench
    bench.close()


@pytest.mark.parametrize("name", [ARM, POSITION_ARM])
def test_a_reflex_aborts_the_goal_and_says_what_it_was(bench, name):
    bench.start(name)
    goal = bench.send(bench.turned(INTO_THE_WALL), name=name, pace=2.0)

    done = bench.finish(goal, name)

    assert done.status == "aborted"
    assert "arm 'panda' went to reflex (cartesian_reflex at y: " in done.result.message
    assert "allowed is 20 N" in done.result.message
    assert 0.2 < done.progress < 0.8
    report = bench.client.robot("panda").errors()
    assert report.robot_mode == "reflex"
    assert report.errors[0].name == "cartesian_reflex"
    assert bench.client.controller(name).state == "stopped"
    bench.run(0.2)
    held = bench.positions()
    bench.run(1.0)
    assert bench.positions() == pytest.approx(held, abs=2e-3)


def test_without_reflexes_the_path_tolerance_names_joint_error_and_bound(
    insensitive_bench,
):
    bench = insensitive_bench
    bench.start()
    goal = bench.send(bench.turned(INTO_THE_WALL), pace=2.0, path_tolerance=BOUNDS)

    done = bench.finish(goal)

    assert done.status == "aborted"
    assert done.result.code == -4
    details = done.result.details
    # The wrist gives way before the first joint does.
    assert details["joint"] in JOINTS
    assert details["quantity"] == "position"
    assert abs(details["error"]) > details["tolerance"] == 0.05
    assert 0.3 < details["time"] < 2.0
    assert done.result.message.startswith(
        f"Joint '{details['joint']}' has a position error of {details['error']:.6g} rad"
    )
    bench.run(0.5)
    held = bench.positions()
    bench.run(1.0)
    assert bench.positions() == pytest.approx(held, abs=2e-3)
    assert bench.client.controller(ARM).state == "running"
    back = bench.finish(bench.send(bench.turned(-0.2)))
    assert back.status == "succeeded"


def test_without_a_path_tolerance_the_goal_tolerance_ends_it(insensitive_bench):
    bench = insensitive_bench
    bench.start()
    goal = bench.send(bench.turned(JUST_BEHIND_IT), pace=2.0)

    done = bench.finish(goal)

    assert done.status == "aborted"
    assert done.result.code == -5
    assert done.result.details["joint"] in JOINTS
    assert abs(done.result.details["error"]) > done.result.details["tolerance"] == 0.05
