"""FrankaHW moves an arm behind the Franka Control Interface as it moves it directly.

Both are stepped: no clock, no socket, and every run is the same. What differs is the
way of a command: through the messages of the protocol and the server, or straight.
"""

from math import cos, pi, sin

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import (
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.test_franka_hw import JOINTS, PERIOD, ROBOT

CYCLES = 600
POSE, TWIST = FrankaPoseCartesianInterface, FrankaVelocityCartesianInterface
KINDS = {
    "positions": (PositionJointInterface,),
    "velocities": (VelocityJointInterface,),
    "torques": (EffortJointInterface,),
    "torques and positions": (EffortJointInterface, PositionJointInterface),
    "torques and velocities": (EffortJointInterface, VelocityJointInterface),
    "pose": (POSE,),
    "twist": (TWIST,),
    "torques and pose": (EffortJointInterface, POSE),
}


def simulated():
    description = load_robot_files("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)]).arms["panda"]


def behind_the_interface():
    description = load_robot_files("example-robot-data:panda")
    network = SteppedNetwork(simulated())
    return FciArm(network, lambda: ArmModel(description), is_enforced=False)


def make(arm, **settings):
    hw = FrankaHW(arm)
    tree = ParameterTree({"robot": {**ROBOT, "realism": "ideal", **settings}})
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


def starting(kind):
    claims = tuple(
        InterfaceResources(
            interface.type_name,
            ("panda_robot",) if interface in (POSE, TWIST) else JOINTS,
        )
        for interface in KINDS[kind]
    )
    return [ControllerInfo("test", "test/Controller", claims)]


def command(hw, kind, time):
    """Command a swing of all joints, or of the hand, that begins at rest."""
    swing, rate = 1.0 - cos(2.0 * pi * time), 2.0 * pi * sin(2.0 * pi * time)
    for interface in KINDS[kind]:
        provided = hw.get(interface)
        if interface is POSE:
            pose = list(START)
            pose[13] += 0.02 * swing
            provided.get_handle("panda_robot").set_command(pose)
        elif interface is TWIST:
            twist = [0.0, 0.02 * rate, 0.0, 0.0, 0.0, 0.05 * rate]
            provided.get_handle("panda_robot").set_command(twist)
        else:
            for name, start in zip(JOINTS, INITIAL_POSITIONS, strict=True):
                value = {
                    PositionJointInterface: start + 0.05 * swing,
                    VelocityJointInterface: 0.05 * rate,
                    EffortJointInterface: 0.2 * swing,
                }[interface]
                provided.get_handle(name).set_command(value)


def record(hw, kind):
    """Return the measured and the desired positions of every cycle of a motion."""
    hw.read(0.0, PERIOD)
    hw.prepare_switch(starting(kind), [])
    hw.do_switch(starting(kind), [])
    found = []
    for cycle in range(CYCLES):
        hw.read(0.0, PERIOD)
        command(hw, kind, cycle * PERIOD)
        hw.write(0.0, PERIOD)
        found.append((hw.robot_state.q, hw.robot_state.q_d, hw.mode()))
    return found


START = [0.0] * 16


@pytest.mark.parametrize("internal", ["joint_impedance", "cartesian_impedance"])
@pytest.mark.parametrize("kind", KINDS)
def test_trajectories_are_the_same_up_to_one_cycle(kind, internal):
    settings = {"internal_controller": internal, "cutoff_frequency": 100.0}
    arm = simulated()
    arm.refresh_state()
    START[:] = arm.state.O_T_EE_d
    direct = record(make(arm, **settings), kind)
    through = record(make(behind_the_interface(), **settings), kind)

    moved = max(abs(a - b) for a, b in zip(direct[-1][0], direct[0][0], strict=True))
    assert moved > 0.01
    assert {mode for _, _, mode in through[1:]} == {"move"}
    # The arm behind the interface has rested for a few cycles more: torques begin at
    # another rounding of the same pose.
    assert min(differences(direct, through)) < 1e-9


def differences(direct, through):
    """Return the largest difference [rad] without a delay, and with one cycle."""
    for delay in (0, 1):
        pairs = zip(direct, through[delay:], strict=False)
        yield max(
            abs(a - b)
            for one, other in pairs
            for a, b in zip(one[0], other[0], strict=True)
        )
