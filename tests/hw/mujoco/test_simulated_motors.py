"""Motors behind a transmission."""

import pytest

from station.core.hardware.interfaces import (
    ActuatorStateInterface,
    EffortActuatorInterface,
    InterfaceManager,
)
from station.core.hardware.transmissions import SimpleTransmission
from station.hw.mujoco.robot_transmissions import _default
from station.hw.mujoco.simulated_motors import QUANTITIES, SimulatedMotors


@pytest.fixture
def targets():
    return {quantity: [0.0] for quantity in QUANTITIES}


@pytest.fixture
def motors(targets):
    motors = SimulatedMotors(["j_motor"], ["j"], targets)
    motors.connect(_default("j"), SimpleTransmission(50.0, 0.5))
    return motors


def test_state_is_that_of_the_motor_shaft(motors):
    robot = InterfaceManager()
    motors.register(robot)
    motors.joint_state["position"][0] = 0.7
    motors.joint_state["velocity"][0] = 2.0
    motors.joint_state["effort"][0] = 100.0
    motors.update_state()
    (state,) = robot.get(ActuatorStateInterface).handles()
    assert state.get_position() == pytest.approx(50.0 * (0.7 - 0.5))
    assert state.get_velocity() == pytest.approx(100.0)
    assert state.get_effort() == pytest.approx(2.0)


def test_command_acts_on_the_joint(motors, targets):
    robot = InterfaceManager()
    motors.register(robot)
    robot.get(EffortActuatorInterface).get_handle("j_motor").set_command(3.0)
    motors.act("effort")
    assert targets == {"position": [0.0], "velocity": [0.0], "effort": [150.0]}
