"""Faults begin, last, and end."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import HardwareInterfaceError
from station.core.franka import FaultKind, RobotState
from station.core.franka.franka_services import SimulatedFault
from station.hw.franka.arm.arm_description import joint_names
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.franka.simulated.sensor_faults import SensorFaults


@pytest.fixture(scope="module")
def world():
    description = load_robot_files("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)]).world


@pytest.fixture
def faults(world):
    return SensorFaults(world, world.joints(joint_names("panda")), "panda_hand")


def test_packets_are_lost_for_as_long_as_asked(faults):
    faults.inject(SimulatedFault(FaultKind.LOST_PACKETS, 3))
    assert [faults.loses_packet() for _ in range(5)] == [True] * 3 + [False] * 2


def test_lasting_faults_are_listed_until_they_are_cleared(faults):
    faults.inject(SimulatedFault(FaultKind.LOST_PACKETS, 3))
    faults.inject(SimulatedFault(FaultKind.NAN_SENSOR, 5, joint=4))
    faults.inject(SimulatedFault(FaultKind.STUCK_JOINT, 7, joint=2))
    kinds = {(one.kind, one.joint, one.cycles) for one in faults.active()}
    assert kinds == {
        (FaultKind.LOST_PACKETS, 1, 3),
        (FaultKind.NAN_SENSOR, 4, 5),
        (FaultKind.STUCK_JOINT, 2, 7),
    }
    faults.clear()
    assert faults.active() == []


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
