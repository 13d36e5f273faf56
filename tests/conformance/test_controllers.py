"""What every controller of the table must do, unasked."""

import math

import pytest

from station.controllers import CONTROLLERS
from station.core.control.switching import SwitchRequest
from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from tests.conformance.benches import Bench, bench_for


@pytest.fixture(params=CONTROLLERS)
def bench(request):
    return bench_for(request.param)


def takes_set_points(controller_type):
    return (
        bench_for(controller_type).manager.get_controller("it").set_points is not None
    )


@pytest.fixture(params=[t for t in CONTROLLERS if takes_set_points(t)])
def controller_type_with_set_points(request):
    return request.param


def start(bench):
    return bench.manager.switch_controller(SwitchRequest(start=["it"]))


def stop(bench):
    return bench.manager.switch_controller(SwitchRequest(stop=["it"]))


def status(bench):
    (only,) = bench.manager.list_controllers()
    return only


def positions(bench):
    states = bench.robot.get(JointStateInterface)
    return [handle.get_position() for handle in states.handles()]


def test_it_claims_resources_the_robot_has(bench):
    for claim in status(bench).claimed_resources:
        known = bench.robot.get_interface_resources(claim.hardware_interface)
        assert set(claim.resources) <= set(known)


def test_it_starts_without_a_jump_and_lets_the_robot_rest(bench):
    bench.step()
    before = positions(bench)

    result = start(bench)
    bench.step(50)

    assert result.ok
    assert status(bench).fault == ""
    assert status(bench).state.value == "running"
    assert max(result.jump.values(), default=0.0) < 1e-6
    assert positions(bench) == pytest.approx(before, abs=0.002)  # a Franka sags a bit


def test_its_commands_are_finite(bench):
    start(bench)

    for _ in range(50):
        bench.step()
        assert all(math.isfinite(command) for command in bench.commands())


def test_it_stops_and_starts_again_and_again(bench):
    for _ in range(3):
        assert start(bench).ok
        bench.step(3)
        assert stop(bench).ok
        assert status(bench).state.value == "stopped"
    assert status(bench).fault == ""


def test_it_survives_a_reset_while_it_runs(bench):
    start(bench)
    bench.step(3)

    bench.manager.update(bench.time, 0.001, reset_controllers=True)
    bench.step(3)

    assert status(bench).state.value == "running"


@pytest.mark.parametrize("period", [0.0, 0.02])
def test_it_survives_a_cycle_of_another_length(bench, period):
    start(bench)
    bench.step(3)

    bench.manager.update(bench.time + period, period)

    assert status(bench).fault == ""
    assert all(math.isfinite(command) for command in bench.commands())


def test_its_gains_fit_their_schema_and_can_be_set_again(bench):
    tunables = bench.manager.get_controller("it").tunables
    gains, schema = tunables.values, tunables.schema

    assert set(gains) == set(schema)
    for name, value in gains.items():
        assert schema[name].minimum <= value <= schema[name].maximum
    tunables.apply(tunables.checked(gains))
    assert tunables.values == gains


def test_its_set_point_has_names_units_and_ranges(bench):
    port = bench.manager.get_controller("it").set_points
    if port is None:
        pytest.skip("takes no set-points")

    for element in port.elements:
        assert element.name
        assert element.minimum < element.maximum
    with pytest.raises(StationError):
        port.check([0.0] * (len(port.elements) + 1))
    with pytest.raises(StationError):
        port.check([math.nan] * len(port.elements))


def test_its_sample_has_one_number_per_joint(bench):
    controller = bench.manager.get_controller("it")
    start(bench)
    bench.step(100)
    if controller.sample is None:
        pytest.skip("leaves no samples")

    size = len(controller.joint_names)
    assert all(len(values) == size for values in controller.sample[1:])
    assert controller.sample.stamp <= bench.time


def test_it_never_makes_a_command_of_a_sensor_that_reads_nan(bench):
    if not hasattr(bench.robot, "script"):
        pytest.skip("runs on a robot whose sensors do not fail")
    start(bench)
    bench.step(3)
    bench.robot.script.nan_sensors = set(bench.robot.joint_names)

    for _ in range(3):
        bench.step()
        assert all(math.isfinite(command) for command in bench.commands())

    assert status(bench).state.value in {"running", "aborted"}


@pytest.mark.parametrize("controller_type", CONTROLLERS)
def test_without_parameters_it_is_refused_with_a_reason_or_works(controller_type):
    bench = Bench()
    bench.parameters.set("it/type", controller_type)

    try:
        bench.manager.load_controller("it")
    except StationError:
        assert bench.manager.list_controllers() == []
    else:
        assert start(bench).ok


def test_a_set_point_times_out_on_the_wall_clock_while_simulated_time_stands(
    controller_type_with_set_points,
):
    bench = bench_for(controller_type_with_set_points, command_timeout=0.2)
    start(bench)
    bench.step(3)
    port = bench.manager.get_controller("it").set_points
    values = bench.resting_set_point()
    port.check(values)
    port.post(values)
    bench.pause(3)
    assert port.last == pytest.approx(values)
    taken = port.last
    bench.clock.advance(0.19)
    bench.pause()
    assert port.last is taken

    bench.clock.advance(0.02)
    bench.pause()

    assert port.last is not taken
    assert status(bench).state.value == "running"


def test_a_timeout_can_stop_the_controller_also_while_simulated_time_stands(
    controller_type_with_set_points,
):
    bench = bench_for(
        controller_type_with_set_points,
        command_timeout=0.2,
        command_timeout_action="stop",
    )
    start(bench)
    bench.step(3)
    port = bench.manager.get_controller("it").set_points
    port.post(bench.resting_set_point())
    bench.pause(3)
    assert status(bench).state.value == "running"

    bench.clock.advance(0.21)
    bench.pause()

    assert status(bench).state.value != "running"
    assert "arrived in time" in status(bench).fault
