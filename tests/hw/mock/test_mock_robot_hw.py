"""The mock does what its parameters and its script say."""

import math

import pytest

from station.core.clock import ManualClock
from station.core.errors import ParameterError, SwitchRefusedError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    ForceTorqueSensorInterface,
    ImuSensorInterface,
    JointStateInterface,
    PositionJointInterface,
    PosVelAccJointInterface,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    SwitchState,
)
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW


def robot_with(**values):
    params = Parameters()
    params.set("hw", values)
    robot = MockRobotHW()
    robot.init(params, params.namespace("hw"))
    return robot


@pytest.fixture
def robot():
    return robot_with(joints=["a", "b"], initial_positions=[0.5, -0.5])


def info(name, interface, *resources):
    claims = (InterfaceResources(interface.type_name, resources),)
    return ControllerInfo(name, "test/Type", claims)


ARM = info("arm", VelocityJointInterface, "a")


def test_mock_has_two_joints_without_parameters():
    assert robot_with().get(JointStateInterface).get_names() == ["joint1", "joint2"]


def test_mock_joints_begin_at_the_configured_positions(robot):
    robot.read(0.0, 0.0)

    states = robot.get(JointStateInterface)
    assert [states.get_handle(n).get_position() for n in "ab"] == [0.5, -0.5]


@pytest.mark.parametrize(
    "interface",
    [
        EffortJointInterface,
        VelocityJointInterface,
        PositionJointInterface,
        PosVelJointInterface,
        PosVelAccJointInterface,
    ],
)
def test_mock_joints_take_every_kind_of_command(robot, interface):
    assert robot.get(interface).get_names() == ["a", "b"]


def test_mock_has_a_force_torque_sensor_and_an_imu(robot):
    wrench = robot.get(ForceTorqueSensorInterface).get_handle("mock_wrench")
    imu = robot.get(ImuSensorInterface).get_handle("mock_imu")

    assert wrench.get_force() == [0.0, 0.0, 0.0]
    assert imu.get_linear_acceleration() == [0.0, 0.0, 9.81]


@pytest.mark.parametrize(
    "values",
    [
        {"joints": ["a", "a"]},
        {"joints": "a"},
        {"joints": ["a"], "initial_positions": [0.0, 1.0]},
        {"inertia": 0.0},
        {"damping": -1.0},
        {"switch_cycles": "two"},
    ],
)
def test_impossible_parameters_are_refused(values):
    with pytest.raises(ParameterError):
        robot_with(**values)


def test_only_a_claimed_joint_moves(robot):
    robot.joints.velocity_command[:] = [1.0, 1.0]

    robot.do_switch([ARM], [])
    robot.read(0.1, 0.1)
    robot.do_switch([], [ARM])
    robot.read(0.2, 0.1)

    assert robot.joints.position == [pytest.approx(0.6), -0.5]
    assert robot.switches == [(("arm",), ()), ((), ("arm",))]


def test_a_joint_is_handed_over_in_one_switch(robot):
    successor = info("successor", EffortJointInterface, "a")
    robot.do_switch([ARM], [])

    robot.do_switch([successor], [ARM])

    assert robot.joints.mode == [EffortJointInterface.type_name, ""]


def test_a_switch_takes_as_many_cycles_as_ordered():
    robot = robot_with(joints=["a"], switch_cycles=2)
    robot.do_switch([ARM], [])
    states = []

    for _ in range(3):
        states.append((robot.switch_result(), robot.switch_result_for(ARM)))
        robot.write(0.0, 0.01)

    waiting, done = SwitchState.ONGOING, SwitchState.DONE
    assert states == [(waiting, waiting), (waiting, waiting), (done, done)]


def test_a_switch_fails_for_the_controllers_named(robot):
    robot.script.failing = {"arm"}
    other = info("other", VelocityJointInterface, "b")

    assert robot.switch_result() is SwitchState.ERROR
    assert robot.switch_result_for(ARM) is SwitchState.ERROR
    assert robot.switch_result_for(other) is SwitchState.DONE


def test_a_switch_is_refused_with_the_scripted_reason(robot):
    robot.script.refusal = "the brake is on"

    with pytest.raises(SwitchRefusedError, match="the brake is on"):
        robot.prepare_switch([ARM], [])


def test_sensors_can_read_nan_and_recover(robot):
    robot.script.nan_sensors = {"a"}
    robot.read(0.0, 0.0)
    a, b = robot.get(JointStateInterface).handles()
    assert math.isnan(a.get_position())
    assert math.isnan(a.get_velocity())
    assert b.get_position() == -0.5

    robot.script.nan_sensors = set()
    robot.read(0.0, 0.0)

    assert a.get_position() == 0.5


def test_slow_cycles_take_their_time_once(robot):
    clock = robot.clock = ManualClock(0.0)
    robot.script.slow_cycles = [0.25, 0.5]

    times = []
    for _ in range(3):
        robot.read(0.0, 0.0)
        times.append(clock.now())

    assert times == [0.25, 0.75, 0.75]


def test_reading_can_fail(robot):
    robot.script.read_error = OSError("unplugged")

    with pytest.raises(OSError, match="unplugged"):
        robot.read(0.0, 0.0)


def test_the_mode_is_scripted(robot):
    robot.script.mode = "reflex"

    assert robot.mode() == "reflex"
