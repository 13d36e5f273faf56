"""State and model under upstream's names, and joints close to a limit."""

from station.core.description.robot_files import load_robot_files
from station.hw.franka.commands.arm_interfaces import model_interface, state_interface
from station.hw.franka.commands.joint_limit_warnings import joint_limit_warnings
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.urdf_loader import load_urdf


def test_names_are_upstreams():
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]

    model = arm.load_model()
    assert state_interface(arm, "panda", model).get_names() == ["panda_robot"]
    models = model_interface(arm, "panda", model)
    assert models.get_names() == ["panda_model", "panda_robot"]


def test_joint_close_to_a_limit_is_named():
    urdf = load_urdf(load_robot_files("example-robot-data:panda"))
    joint = urdf.joints["panda_joint1"]

    assert joint_limit_warnings([joint], [0.0], 0.1) == []
    assert joint_limit_warnings([joint], [-2.85], 0.1) == [
        "panda_joint1 is 2.7 degrees from a limit"
    ]
