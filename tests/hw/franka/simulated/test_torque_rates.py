"""How fast the torques of a simulated arm change, which few ask for."""

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.franka.simulated.realism import TYPICAL


@pytest.mark.parametrize("realism", [None, TYPICAL])
def test_rates_of_the_torques_are_their_changes_in_a_cycle(realism) -> None:
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description, realism=realism)]).arms["panda"]
    arm.start_motion(ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE)
    for cycle in range(5):
        before = list(arm.state.tau_J)
        arm.command_joint_torques([0.1 * cycle] * 7)
        arm.read_once()
        arm.refresh_state()
        expected = (np.array(arm.state.tau_J) - before) / 0.001
        assert arm.state.dtau_J == pytest.approx(expected, abs=1e-6)
    assert max(map(abs, arm.state.dtau_J)) > 10.0
