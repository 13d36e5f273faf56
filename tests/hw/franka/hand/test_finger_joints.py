"""The fingers of a simulated hand as joints that controllers claim."""

import pytest

from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW

FINGERS = ("panda_finger_joint1", "panda_finger_joint2")
ROBOT = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
ARM = tuple(f"panda_joint{number}" for number in range(1, 8))


def make(**parameters: object) -> FrankaHW:
    tree = ParameterTree({"robot": {**ROBOT, **parameters}})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


@pytest.fixture
def hw() -> FrankaHW:
    return make()


def info(interface, names=FINGERS, name="hand") -> ControllerInfo:
    claims = (InterfaceResources(interface.type_name, tuple(names)),)
    return ControllerInfo(name, "test/Hand", claims)


def run(hw: FrankaHW, cycles: int) -> None:
    for _ in range(cycles):
        hw.read(0.0, 0.001)
        hw.write(0.0, 0.001)


def command(hw: FrankaHW, interface: type, value: float, names=FINGERS) -> None:
    for name in names:
        hw.get(interface).get_handle(name).set_command(value)


def positions(hw: FrankaHW) -> list[float]:
    interface = hw.get(PositionJointInterface)
    return [h.get_position() for h in interface.handles() if h.name in FINGERS]


def test_they_are_joints_for_positions_and_efforts(hw):
    for interface in (PositionJointInterface, EffortJointInterface):
        assert set(FINGERS) < set(hw.get(interface).get_names())
    for interface in (JointStateInterface, VelocityJointInterface):
        assert tuple(hw.get(interface).get_names()) == ARM


def test_joint_states_have_them_as_franka_gripper_publishes_them():
    hw = make(fingers_in_joint_states=True)
    run(hw, 5)
    states = hw.get(JointStateInterface)
    assert set(states.get_names()) == {*ARM, *FINGERS}
    for name in FINGERS:
        handle = states.get_handle(name)
        assert handle.get_position() == pytest.approx(0.04, abs=1e-3)
        assert handle.get_velocity() == handle.get_effort() == 0.0


def test_unclaimed_fingers_hold_whatever_is_in_their_buffers(hw):
    command(hw, PositionJointInterface, 0.0)
    command(hw, EffortJointInterface, -50.0)
    run(hw, 500)

    assert positions(hw) == pytest.approx([0.04, 0.04], abs=1e-4)


@pytest.mark.parametrize("names", [FINGERS, FINGERS[:1], FINGERS[1:]])
def test_claimed_fingers_go_where_they_are_commanded(hw, names):
    hw.do_switch([info(PositionJointInterface, names)], [])
    command(hw, PositionJointInterface, 0.01, names)
    run(hw, 500)

    assert positions(hw) == pytest.approx([0.01, 0.01], abs=1e-4)


@pytest.mark.parametrize(("value", "end"), [(-1.0, 0.0), (1.0, 0.04)])
def test_positions_stay_within_the_joints_limits(hw, value, end):
    hw.do_switch([info(PositionJointInterface)], [])
    command(hw, PositionJointInterface, value)
    run(hw, 800)

    assert positions(hw) == pytest.approx([end, end], abs=5e-4)


def test_efforts_press_and_released_fingers_hold(hw):
    hw.do_switch([info(EffortJointInterface)], [])
    run(hw, 100)
    assert positions(hw) == pytest.approx([0.04, 0.04], abs=1e-3)
    command(hw, EffortJointInterface, -0.5)
    run(hw, 60)
    (first, second) = positions(hw)
    assert first == pytest.approx(second, abs=5e-4)
    assert first < 0.039
    handle = hw.get(EffortJointInterface).get_handle(FINGERS[0])
    assert handle.get_effort() == pytest.approx(-0.5)

    hw.do_switch([], [info(EffortJointInterface)])
    run(hw, 300)
    held = positions(hw)
    run(hw, 300)

    assert positions(hw) == pytest.approx(held, abs=1e-4)


def test_a_command_that_is_no_number_holds(hw):
    hw.do_switch([info(PositionJointInterface)], [])
    command(hw, PositionJointInterface, float("nan"))
    run(hw, 100)

    assert positions(hw) == pytest.approx([0.04, 0.04], abs=1e-4)


def test_starting_forgets_older_commands(hw):
    command(hw, PositionJointInterface, 0.0)
    hw.do_switch([info(PositionJointInterface)], [])
    run(hw, 300)

    assert positions(hw) == pytest.approx([0.04, 0.04], abs=1e-4)


def test_the_hand_and_the_arm_do_not_disturb_each_other(hw):
    arm = info(EffortJointInterface, ARM, "arm")
    hand = info(EffortJointInterface, FINGERS)
    assert hw.check_for_conflict([arm, hand]) == []
    hw.prepare_switch([arm, hand], [])
    hw.do_switch([arm, hand], [])
    mode = hw.control_mode
    hw.do_switch([], [hand])

    assert mode
    assert hw.control_mode == mode


def test_fingers_follow_one_kind_of_command_at_a_time(hw):
    first = info(PositionJointInterface, FINGERS[:1], "first")
    second = info(EffortJointInterface, FINGERS[1:], "second")

    (conflict,) = hw.check_for_conflict([first, second])

    assert "'first'" in conflict.reason
    assert "'second'" in conflict.reason
    assert hw.check_for_conflict([first]) == []
    twice = [first, info(PositionJointInterface, FINGERS[:1], "third")]
    assert hw.check_for_conflict(twice)


def test_a_reset_opens_the_hand_and_a_running_controller_holds_it(hw):
    hw.do_switch([info(PositionJointInterface)], [])
    command(hw, PositionJointInterface, 0.01)
    run(hw, 300)

    hw.simulated_world().reset({})
    run(hw, 300)

    assert positions(hw) == pytest.approx([0.04, 0.04], abs=1e-4)


def test_efforts_of_controllers_stay_within_the_joints_limit(hw):
    hw.do_switch([info(EffortJointInterface)], [])
    command(hw, EffortJointInterface, -100.0)
    run(hw, 500)

    # 100 N in panda.urdf, for the motor that moves both fingers.
    handle = hw.get(EffortJointInterface).get_handle(FINGERS[0])
    assert handle.get_effort() == pytest.approx(-50.0)
