"""The gripper's action with and without something between the fingers, over REST."""

import pytest

from station.core.franka.arms import Arms
from tests.system.arm_bench import ARM, ArmBench

pytestmark = pytest.mark.long

FINGER = "panda_finger_joint1"
PARAMETERS = {
    "joint": FINGER,
    "goal_tolerance": 0.002,
    "stall_timeout": 0.3,
    "stall_velocity_threshold": 0.003,
    "max_effort": 20.0,
}
GAINS = {"gains": {FINGER: {"p": 1000.0, "d": 20.0, "i": 0.0}}}
HALF_WIDTH = 0.02
BOX = (
    "{name: box, type: box, size: [0.03, 0.04, 0.03], position: [0.307, 0, 0.487], "
    "mass: 0.1}"
)
PILLAR = (
    "{name: pillar, type: box, size: [0.02, 0.02, 0.472], position: [0.307, 0, 0.236]}"
)
SCENES = {"air": "", "box": f"scene: {{objects: [{BOX}, {PILLAR}]}}\n"}
KINDS = ["effort", "position"]


@pytest.fixture
def make_bench(tmp_path):
    """Return a way to build the bench with a gripper's controller that runs."""
    benches = []

    def make(kind, scene):
        bench = ArmBench(tmp_path, SCENES[scene])
        benches.append(bench)
        parameters = PARAMETERS | (GAINS if kind == "effort" else {})
        kind = f"{kind}_controllers/GripperActionController"
        bench.client.load_controller("gripper", kind, parameters)
        bench.client.switch_controllers(start=["gripper", ARM])
        bench.run(0.1)
        return bench

    yield make
    for bench in benches:
        bench.close()


def move(bench, position, **command):
    """Send the fingers to a position [m]."""
    goal = {"command": {"position": position, **command}}
    return bench.client.submit_goal("gripper", goal)


def finger(bench):
    return bench.client.controller_state("gripper").actual[0]


def hand_height(bench):
    return Arms(bench.station.robots).state("panda").O_T_EE[14]


def box_height(bench):
    return bench.station.loop.hw.simulated_world().world.data.body("box").xpos[2]


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_stalls_the_fingers_which_hold_it(make_bench, kind):
    bench = make_bench(kind, "box")
    arm = bench.positions()

    done = bench.finish(move(bench, 0.0, max_effort=10.0), "gripper")

    assert done.status == "aborted"
    details = done.result.details
    assert (details["stalled"], details["reached_goal"]) == (True, False)
    # The fingers' pads and the box give way a little.
    assert HALF_WIDTH - 0.008 < details["position"] < HALF_WIDTH + 0.001
    assert details["effort"] < -4.0
    assert f"'{FINGER}' stands still at " in done.result.message
    held = finger(bench)
    bench.run(1.0)
    assert finger(bench) == pytest.approx(held, abs=1e-4)
    assert bench.positions() == pytest.approx(arm, abs=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_held_is_lifted_and_let_go(make_bench, kind):
    bench = make_bench(kind, "box")
    bench.finish(move(bench, 0.0, max_effort=10.0), "gripper")
    before, hand = box_height(bench), hand_height(bench)

    lift = bench.finish(bench.send(bench.turned(0.0, -0.15), pace=1.5))

    assert lift.status == "succeeded"
    bench.run(0.5)
    rise = hand_height(bench) - hand
    assert rise > 0.03
    assert box_height(bench) == pytest.approx(before + rise, abs=2e-3)
    done = bench.finish(move(bench, 0.038), "gripper")
    assert done.status == "succeeded"
    bench.run(0.5)
    assert box_height(bench) < before


@pytest.mark.parametrize("kind", KINDS)
def test_on_air_the_fingers_close_and_say_that_they_did(make_bench, kind):
    bench = make_bench(kind, "air")

    done = bench.finish(move(bench, 0.0), "gripper")

    assert done.status == "succeeded"
    details = done.result.details
    assert (details["stalled"], details["reached_goal"]) == (False, True)
    assert details["position"] == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_command_while_the_fingers_move_replaces_the_old_one(make_bench, kind):
    bench = make_bench(kind, "air")
    first = move(bench, 0.0)
    bench.run(0.05)
    assert finger(bench) < 0.0395

    second = bench.finish(move(bench, 0.035), "gripper")

    assert bench.goal(first, "gripper").status == "preempted"
    assert "replaced" in bench.goal(first, "gripper").result.message
    assert second.status == "succeeded"
    assert finger(bench) == pytest.approx(0.035, abs=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_stop_with_nothing_running_changes_nothing(make_bench, kind):
    bench = make_bench(kind, "air")
    done = bench.finish(move(bench, 0.02), "gripper")
    bench.run(0.5)
    before = finger(bench)

    assert bench.client.cancel_goal("gripper", done.id) == done
    bench.client.stop("nothing moves")
    bench.client.stop("twice")
    bench.run(0.5)

    assert bench.goal(done, "gripper") == done
    position = bench.station.loop.hw.simulated_world().grippers["panda"].read_position()
    assert position == pytest.approx(before, abs=1e-3)
