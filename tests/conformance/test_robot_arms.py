"""Every arm behind the seam conforms; another driver joins by a line in `ARMS`."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.testing import ArmConformance
from tests.hw.franka.scripted_arm import ScriptedArm


def simulated():
    description = load_robot_files("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)]).arms["panda"]


ARMS = {"simulated": simulated, "scripted": ScriptedArm}


class TestEveryArm(ArmConformance):
    """The suite, over the arms."""

    @pytest.fixture(params=ARMS)
    def arm(self, request):
        return ARMS[request.param]()
