"""The controller of PIDs: references, set-points, feed-forward, and in a chain."""

from math import inf

import pytest

from station.core.errors import ControllerLoadError, ParameterError
from station.testing import Bench

KIND = "pid_controller/PidController"
GAINS = {"p": 2.0, "i": 0.0, "d": 0.5, "feedforward_gain": 0.25}


def load(bench, name="pid", joint="joint1", **more):
    return bench.load_controller(
        name,
        KIND,
        **{
            "dof_names": [joint],
            "command_interface": "effort",
            "reference_and_state_interfaces": ["position", "velocity"],
            "gains": {joint: GAINS},
            **more,
        },
    )


@pytest.fixture
def bench():
    bench = Bench(None, {"joints": ["joint1", "joint2"]})
    bench.robot.joints.position[0] = 0.2
    return bench


def test_it_starts_at_rest_where_the_joint_is(bench):
    controller = load(bench)
    bench.switch(start=["pid"])
    bench.step(3)

    assert bench.status("pid").fault is None
    assert controller.sample.desired == [0.2]
    assert controller.sample.output == [0.0]


def test_a_set_point_with_rates_is_followed_by_the_formula(bench):
    controller = load(bench)
    bench.switch(start=["pid"])
    bench.step()
    controller.set_points.post([0.5, 0.1])
    measured = bench.robot.joints.velocity[0]
    bench.step()

    error, rate = 0.5 - controller.sample.actual[0], 0.1 - measured
    expected = 2.0 * error + 0.5 * rate + 0.25 * 0.1
    assert controller.sample.output == pytest.approx([expected])


def test_feed_forward_is_switched_on_while_it_runs(bench):
    controller = load(
        bench,
        reference_and_state_interfaces=["velocity"],
        gains={"joint1": {}},
        enable_feedforward=False,
    )
    bench.switch(start=["pid"])
    controller.tunables.apply({
        **controller.tunables.values,
        "joint1/feedforward_gain": 0.5,
    })
    controller.set_points.post([3.0])
    bench.step()
    assert controller.sample.output == [0.0]

    controller.tunables.apply({**controller.tunables.values, "enable_feedforward": 1.0})
    bench.step()
    assert controller.sample.output == [1.5]


def one(bench, **gains):
    """Load a PID of one position, and start it; the joint is at 0.2."""
    more = {
        "reference_and_state_interfaces": ["position"],
        "gains": {"joint1": {"p": 1.0, "i": 2.0, **gains}},
    }
    controller = load(bench, **more)
    bench.switch(start=["pid"])
    return controller


def test_the_feed_forward_is_on_unless_it_is_switched_off(bench):
    controller = one(bench, feedforward_gain=0.5)
    controller.set_points.post([3.0])
    bench.step()

    assert controller.sample.output == pytest.approx([2.8 + 0.5 * 3.0])


def test_the_integral_part_has_bounds_whatever_the_strategy(bench):
    controller = one(bench, i_clamp_max=0.001, i_clamp_min=-0.5)
    controller.set_points.post([0.7])
    bench.step(3)

    # 2.0 * 0.5 * 0.001 s is more than the bound, and counts from the second cycle.
    assert controller.sample.output == pytest.approx([0.5 + 0.001], abs=1e-5)


@pytest.mark.parametrize(
    ("more", "kept"), [({}, True), ({"save_i_term": False}, False)]
)
def test_the_integral_part_outlives_a_stop(bench, more, kept):
    controller = one(bench, **more)
    controller.set_points.post([0.7])
    bench.step(10)
    bench.switch(stop=["pid"])
    before = controller._pids.parts[0]
    bench.switch(start=["pid"])
    bench.step()

    assert before > 0.0
    error = controller.sample.error[0]
    expected = error + (before if kept else 0.0)
    assert controller.sample.output == pytest.approx([expected])


@pytest.mark.parametrize("kind", ["position", "velocity"])
def test_it_starts_from_the_measured_value(bench, kind):
    controller = load(bench, reference_and_state_interfaces=[kind])
    measured = getattr(bench.robot._measured, kind)
    measured[0] = 0.3
    controller.starting(0.0)
    measured[0] = 0.4
    for _ in range(2):
        controller.update(0.001, 0.001)

    assert controller.sample.desired == [0.3]


def test_it_may_wait_for_the_first_reference(bench):
    controller = load(
        bench,
        reference_and_state_interfaces=["position"],
        set_current_state_as_first_setpoint=False,
    )
    bench.switch(start=["pid"])
    bench.robot.joints.position[0] = 0.1
    bench.step()
    assert controller.sample.output == [0.0]

    controller.set_points.post([0.3])
    bench.step()
    assert controller.sample.output[0] > 0.0


def test_bounds_may_be_infinite(bench):
    controller = one(bench, u_clamp_max=inf, u_clamp_min=-inf, i_clamp_max=inf)
    controller.set_points.post([3.0])
    bench.step()

    assert controller.sample.output == pytest.approx([2.8])


def test_bounds_of_the_command_may_be_switched_off(bench):
    controller = one(bench, u_clamp_max=0.1, u_clamp_min=-0.1, saturation=False)
    controller.set_points.post([3.0])
    bench.step()

    assert controller.sample.output == pytest.approx([2.8])


def test_a_preceding_pid_commands_the_reference_of_another(bench):
    inner = load(
        bench,
        "inner",
        reference_and_state_interfaces=["velocity"],
        gains={"joint1": {"p": 3.0}},
    )
    outer = load(
        bench,
        "outer",
        dof_names=["inner/joint1"],
        reference_and_state_dof_names=["joint1"],
        command_interface="velocity",
        reference_and_state_interfaces=["position"],
        gains={"inner/joint1": {"p": 4.0}},
    )
    bench.switch(start=["inner", "outer"])
    outer.set_points.post([0.3])
    bench.step()

    wanted = 4.0 * (0.3 - outer.sample.actual[0])
    assert wanted > 0.1
    assert outer.sample.output == pytest.approx([wanted])
    assert inner.sample.desired == pytest.approx([wanted])
    error = wanted - inner.sample.actual[0]
    assert inner.sample.output == pytest.approx([3.0 * error])

    # Without its predecessor it rests, and takes no set-point from before.
    bench.switch(stop=["outer"])
    bench.step()
    assert inner.sample.desired == [0.0]


def test_the_measured_value_is_exported(bench):
    controller = load(bench)
    bench.switch(start=["pid"])
    bench.step()

    names = [each.name for each in controller.on_export_state_interfaces()]
    assert names == ["joint1/position", "joint1/velocity"]
    first = controller.on_export_state_interfaces()[0]
    assert first.storage[first.index] == controller.sample.actual[0]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"dof_names": []}, "one name for each"),
        ({"reference_and_state_dof_names": ["joint1", "joint2"]}, "one name for each"),
        ({"reference_and_state_interfaces": ["effort", "position"]}, "one interface"),
        ({"command_interface": "voltage"}, "one of position, velocity, effort"),
        ({"gains": {"joint1": {"antiwindup_strategy": "magic"}}}, "back_calculation"),
        ({"gains": {"joint1": {"u_clamp_max": -1.0, "u_clamp_min": 1.0}}}, "u_clamp"),
        ({"gains": {"joint1": {"i_clamp_max": -1.0}}}, "0 or more"),
        ({"gains": {"joint1": {"i_clamp_min": 1.0}}}, "0 or less"),
        ({"gains": {"joint1": {"tracking_time_constant": -1.0}}}, "0 or more"),
    ],
)
def test_what_does_not_fit_is_refused(bench, more, words):
    with pytest.raises(ParameterError, match=words):
        load(bench, **more)


def test_measured_values_from_a_topic_are_refused(bench):
    with pytest.raises(ControllerLoadError, match="topic"):
        load(bench, use_external_measured_states=True)
