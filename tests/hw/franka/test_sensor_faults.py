"""Faults begin, last, and end."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.interfaces import FaultKind, RobotState
from station.core.interfaces.franka_services import SimulatedFault
from station.hw.franka.arm_names import joint_names
from station.hw.franka.sensor_faults import SensorFaults
from station.hw.franka.simulation import ArmPlacement, simulate
from station.hw.robot_description import load_robot_description


@pytest.fixture(scope="module")
def world():
    description = load_robot_description("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)]).world


@pytest.fixture
def faults(world):
    return SensorFaults(world, world.joints(joint_names("panda")), "panda_hand")


def test_packets_are_lost_for_as_long_as_asked(faults):
    faults.inject(SimulatedFault(FaultKind.LOST_PACKETS, 3))
    assert [faults.loses_packet() for _ in range(5)] == [True] * 3 + [False] * 2


def test_delay_happens_once(faults):
    faults.inject(SimulatedFault(FaultKind.DELAYED_CYCLE, 4))
    assert [faults.take_delay() for _ in range(2)] == [4, 0]


def test_sensor_is_blind_for_as_long_as_asked(faults):
    faults.inject(SimulatedFault(FaultKind.NAN_SENSOR, 2, joint=3))
    for blind in (True, True, False):
        state = RobotState()
        faults.disturb(state)
        assert (state.q[2] != 0.0) is blind


def test_joint_gets_free_again(faults, world):
    before = world.model.dof_damping.tolist()
    faults.inject(SimulatedFault(FaultKind.STUCK_JOINT, 2))
    assert world.model.dof_damping[0] > 1e5
    faults.clear()
    assert world.model.dof_damping.tolist() == before


def test_collision_needs_something_to_hit(world):
    faults = SensorFaults(world, world.joints(joint_names("panda")), "nose")
    with pytest.raises(HardwareInterfaceError, match="no body 'nose'"):
        faults.inject(SimulatedFault(FaultKind.COLLISION, 1))
