"""A world runs one trial after the other, and none leaves anything behind."""

import numpy as np
import pytest

from station.experiments.trial_world import TrialWorld
from station.trials.errors import ExperimentError
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Push, Relay, Sine, Step, Waypoints
from tests.experiments.conftest import GROUP

JTC = "effort_joint_trajectory_controller"
FIRST = "panda_joint1"


def play(world, controller, *commands, duration=0.3, **parameters):
    script = Script(controller=controller, duration=duration, commands=commands)
    return world.record(Trial(world.setup, script, parameters))


def test_reset_world_equals_a_fresh_one_bit_for_bit(panda, world, step):
    disturbed = step.with_parameters(
        {
            f"scale/{GROUP}/p": 0.5,
            "load": 2.0,
            "friction": 0.3,
            "damping/panda_joint2": 4.0,
            "delay": 2,
            "noise/position": 1e-4,
        },
        seed=3,
    )
    script = disturbed.script.model_copy(
        update={
            "commands": (Push(link="panda_link7", at=0.0, lasts=9, force=(0, 20, 0)),)
        }
    )
    world.run(disturbed)
    world.run(Trial(panda, script))

    fresh = TrialWorld(panda)
    (result, reused), (other, first) = world.record(step), fresh.record(step)

    assert reused.to_bytes() == first.to_bytes()
    assert result.metrics == other.metrics
    assert (
        fresh.record(disturbed)[1].to_bytes() == world.record(disturbed)[1].to_bytes()
    )


def test_metrics_of_a_step(world, step):
    quick = step.with_parameters({f"scale/{GROUP}/p": 3.0, f"scale/{GROUP}/d": 0.75})
    result = world.run(quick)

    assert result.state == "done"
    assert result.hash == quick.hash
    assert 0.03 < result.metrics["rise_time"] < 0.12
    assert result.metrics["reflexes"] == 0.0


@pytest.mark.parametrize(
    ("parameter", "value", "change"),
    [
        (f"scale/{GROUP}/p", 0.5, "gains"),
        (f"gains/{GROUP}/{FIRST}/d", 60.0, "gains"),
        ("load", 2.0, "weight"),
        ("friction", 2.0, "friction"),
        ("damping", 10.0, "damping"),
        ("delay", 5.0, "delay"),
        ("noise/velocity", 0.01, "noise"),
    ],
)
def test_every_parameter_changes_the_motion(world, step, parameter, value, change):
    quiet, disturbed = (
        world.record(trial)[1]
        for trial in (step, step.with_parameters({parameter: value}))
    )

    if change == "weight":  # carried by the joints that lift, e.g. the fourth
        sag = disturbed.position[-1, 3] - quiet.position[-1, 3]
        assert sag < -1e-3
    elif change == "noise":
        assert np.std(disturbed.velocity[:5, 0]) > 0.002 > np.std(quiet.velocity[:5, 0])
    elif change == "delay":
        moved = [np.argmax(abs(t.velocity[:, 0]) > 1e-3) for t in (quiet, disturbed)]
        assert moved[1] - moved[0] == 5
    else:  # weaker, more damped or held back: it is behind
        assert disturbed.position[70, 0] < quiet.position[70, 0] - 1e-4


def test_seed_decides_the_noise(world, step):
    noisy = step.with_parameters({"noise/position": 1e-3})

    one, other = (
        world.record(noisy.with_parameters({}, seed))[1].position for seed in (1, 2)
    )

    assert (one != other).any()
    assert (one == world.record(noisy.with_parameters({}, 1))[1].position).all()


def test_trajectory_controller_follows_waypoints(world):
    way = Waypoints(joint=FIRST, times=(0.5,), values=(0.1,))

    result, trace = play(world, JTC, way, duration=0.6)

    assert result.state == "done"
    assert trace.desired[-1, 0] == pytest.approx(0.1, abs=1e-6)
    assert trace.position[-1, 0] == pytest.approx(0.1, abs=5e-3)
    # A quintic between dense points of a motion with the least jerk is that motion.
    assert trace.desired[251, 0] == pytest.approx(0.05, abs=1e-3)


def test_relay_swings_about_the_middle(world):
    _, trace = play(world, GROUP, Relay(joint=FIRST, amplitude=0.05), duration=0.6)

    sides = np.sign(trace.desired[10:, 0] - trace.desired[0, 0] + 0.05)
    assert (np.diff(trace.desired[:, 0]) != 0.0).sum() >= 4
    assert sides.all()
    assert abs(trace.position[:, 0]).max() < 0.06


@pytest.mark.parametrize(
    ("controller", "command", "parameters", "reason"),
    [
        (
            "arm",
            Sine(joint=FIRST, amplitude=0.1, frequency=1),
            {},
            "No controller 'arm'",
        ),
        (
            JTC,
            Step(joint=FIRST, amplitude=0.1),
            {},
            "have no jumps; the script has a step",
        ),
        (GROUP, Step(joint="elbow", amplitude=0.1), {}, "has no joint 'elbow'"),
        (GROUP, Push(link="x", at=0, lasts=1, force=(1, 0, 0)), {}, "no body 'x'"),
        (GROUP, None, {"weight": 1.0}, "Trials have no parameter 'weight'"),
        (GROUP, None, {"load": -1.0}, "'load' cannot be -1; allowed are 0 to 100"),
        (GROUP, None, {"delay": 1.5}, "allowed are whole numbers 0 to 100"),
        (GROUP, None, {"friction/elbow": 1.0}, "has no joint 'elbow'"),
        (GROUP, None, {f"gains/{GROUP}/x": 1.0}, "has no gain 'x'"),
        (GROUP, None, {f"scale/{GROUP}/x": 1.0}, "ends in '/x'"),
        (GROUP, None, {"gains/x/y": 1.0}, "'x'"),
    ],
)
def test_refused_trial_fails_by_name_and_the_next_goes_on(
    world, step, controller, command, parameters, reason
):
    before = world.run(step).metrics

    commands = () if command is None else (command,)
    result, _ = play(world, controller, *commands, duration=0.05, **parameters)

    assert result.state == "failed"
    assert reason in result.reason
    assert world.run(step).metrics == before


def test_trial_in_which_the_robot_gives_up_has_failed(world, step):
    hard = Push(link="panda_link7", at=0.02, lasts=0.2, force=(0, 90, 0))

    result, trace = play(world, GROUP, hard, duration=0.5)

    assert result.state == "failed"
    assert "reflex" in result.reason
    assert result.metrics["reflexes"] == 1.0
    assert len(trace.time) < 500
    assert world.run(step).state == "done"


def test_controller_that_was_stopped_before_a_command_is_told_with_the_cause(world):
    """Nobody has looked at the robot between its reflex and the next command."""
    hard = Push(link="panda_link7", at=0.02, lasts=0.2, force=(0, 90, 0))
    later = Step(joint=FIRST, amplitude=0.1, at=0.08)

    result, trace = play(world, GROUP, hard, later, duration=0.5)

    assert result.state == "failed"
    assert "reflex" in result.reason
    assert trace is not None
    assert result.metrics["reflexes"] == 1.0


def test_diverging_trial_is_told(world, step):
    result = world.run(step.with_parameters({f"gains/{GROUP}/{FIRST}/d": -3000.0}))

    assert result.state == "failed"
    assert result.reason
    assert world.run(step).state == "done"


def test_robot_without_a_simulation_is_refused():
    mock = {"robot": {"type": "mock_hw/MockRobotHW", "joints": ["a"]}}

    with pytest.raises(ExperimentError, match="MockRobotHW is not simulated"):
        TrialWorld(Setup.load(mock))
