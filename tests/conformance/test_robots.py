"""What every robot of the table must do, unasked."""

import math

import pytest

from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    SwitchState,
)
from station.hw import HARDWARE
from station.hw.robot_loader import create_robot
from tests.conformance.benches import JOINTS, PERIOD, Bench


@pytest.fixture(params=HARDWARE)
def robot_type(request):
    return request.param


@pytest.fixture
def bench(robot_type):
    return Bench(robot_type)


def interfaces(bench):
    found = [bench.robot.get(kind) for kind in bench.robot.interface_types()]
    return [i for i in found if isinstance(i, HardwareResourceManager)]


def commandable(bench):
    """Return (wire name, resources) of every interface with commands."""
    return [
        (interface.type_name, interface.get_names())
        for interface in interfaces(bench)
        if any(handle.command_slots() for handle in interface.handles())
    ]


def states(bench):
    return [
        (handle.get_position(), handle.get_velocity(), handle.get_effort())
        for handle in bench.robot.get(JointStateInterface).handles()
    ]


def test_it_offers_joint_states_by_name(bench):
    assert set(JOINTS) <= set(bench.robot.get(JointStateInterface).get_names())


def test_every_interface_has_a_name_on_the_wire(bench):
    names = bench.robot.get_names()

    assert len(set(names)) == len(names)
    assert all("::" in name or "." in name for name in names)


def test_its_states_are_finite_from_the_first_cycle_on(bench):
    for _ in range(5):
        bench.step()
        assert all(math.isfinite(value) for row in states(bench) for value in row)


def test_it_holds_still_when_nothing_runs(bench):
    bench.step()
    before = [row[0] for row in states(bench)]

    bench.step(100)

    after = [row[0] for row in states(bench)]
    assert after == pytest.approx(before, abs=0.002)  # a simulated arm sags a bit


def test_its_rest_commands_fit_its_handles_and_are_finite(bench):
    bench.step()
    for interface in interfaces(bench):
        for handle in interface.handles():
            slots = handle.command_slots()
            rest = interface.origin(handle.name).rest_commands(handle.name)
            limits = interface.origin(handle.name).start_jump_limits(handle.name)
            assert len(rest) == len(limits) == len(slots)
            assert all(math.isfinite(value) for value in rest)
            assert all(limit > 0.0 for limit in limits)


def test_reading_does_not_change_commands(bench):
    bench.step()
    before = bench.commands()

    bench.robot.read(bench.time, PERIOD)

    assert bench.commands() == before


def test_every_command_interface_can_be_switched_to_and_off_again(bench):
    bench.step()
    for type_name, resources in commandable(bench):
        if not type_name.endswith("JointInterface"):
            continue
        names = tuple(r for r in resources if r in JOINTS)
        info = ControllerInfo(
            "it", "test/Type", (InterfaceResources(type_name, names),)
        )
        bench.robot.prepare_switch([info], [])
        bench.robot.do_switch([info], [])
        for _ in range(50):
            bench.step()
            if bench.robot.switch_result_for(info) is SwitchState.DONE:
                break
        assert bench.robot.switch_result_for(info) is SwitchState.DONE
        bench.robot.do_switch([], [info])
        bench.step()
    assert all(math.isfinite(value) for row in states(bench) for value in row)


def test_a_failed_controller_can_be_taken_off_without_preparation(bench):
    bench.step()
    info = ControllerInfo("it", "test/Type", ())

    bench.robot.do_switch([], [info])
    bench.step()


def test_an_empty_switch_is_fine(bench):
    bench.robot.prepare_switch([], [])
    bench.robot.do_switch([], [])

    assert bench.robot.switch_result() is SwitchState.DONE


def test_a_cycle_may_take_no_time_or_long(bench):
    for period in (0.0, 0.02, PERIOD):
        bench.robot.read(bench.time, period)
        bench.robot.write(bench.time, period)

    assert all(math.isfinite(value) for row in states(bench) for value in row)


def test_its_mode_is_one_word(bench):
    bench.step()

    assert bench.robot.mode()
    assert " " not in bench.robot.mode()


def test_impossible_parameters_are_refused_with_a_reason(bench, robot_type):
    robot = create_robot(robot_type)
    params = bench.parameters.namespace("wrong")
    params.set("", {"joints": 3, "robot_hardware": 3, "arm_id": 3})

    with pytest.raises(StationError) as caught:
        robot.init(bench.parameters, params)

    assert "wrong/" in caught.value.message
