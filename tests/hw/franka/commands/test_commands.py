"""State and model of an arm under upstream's names."""

from station.core.description.robot_files import load_robot_files
from station.hw.franka.commands.arm_interfaces import model_interface, state_interface
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate


def test_names_are_upstreams():
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]

    assert state_interface(arm, "panda").get_names() == ["panda_robot"]
    models = model_interface(arm, "panda")
    assert models.get_names() == ["panda_model", "panda_robot"]
