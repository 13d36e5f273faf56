"""The internal Cartesian impedance is the spring it is set to."""

import pytest

from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.robot_description import load_robot_description


def test_cartesian_impedance_sets_the_deflection_under_load():
    description = load_robot_description("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]
    arm.set_cartesian_impedance([1000.0] * 3 + [300.0] * 3)
    arm.start_motion(
        ControllerMode.CARTESIAN_IMPEDANCE, MotionGeneratorMode.CARTESIAN_VELOCITY
    )
    for cycle in range(1_500):
        arm.command_cartesian_velocity([0.0] * 6)
        if cycle == 100:
            arm.simulation().apply_force("panda_hand", [0.0, 0.0, 10.0], [0.0] * 3, 5.0)
        arm.read_once()
    arm.refresh_state()
    # The hand's centre is not its tip, so it turns a little, too.
    moved = arm.state.O_T_EE[14] - arm.state.O_T_EE_d[14]
    assert moved == pytest.approx(0.01, rel=0.1)
