"""Every setting is refused while the arm moves."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ArmCommandError
from station.core.franka import RobotState
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate

SETTINGS = [
    ("set_joint_impedance", [100.0] * 7),
    ("set_cartesian_impedance", [100.0] * 6),
    ("set_end_effector_frame", RobotState().O_T_EE),
    ("set_stiffness_frame", RobotState().O_T_EE),
    ("set_load", RigidBody(1.0)),
    ("set_collision_behavior", DEFAULT_COLLISION_BEHAVIOR),
]


@pytest.mark.parametrize(("name", "value"), SETTINGS)
def test_setting_is_taken_at_rest_and_refused_in_motion(name, value):
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]
    getattr(arm, name)(value)
    arm.start_motion(ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE)
    with pytest.raises(ArmCommandError, match="while a motion runs"):
        getattr(arm, name)(value)
