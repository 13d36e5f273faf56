"""Every arm behind the seam conforms; another driver joins by a line in `ARMS`."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.testing import ArmConformance
from tests.hw.franka.fci.pumped_network import PumpedNetwork
from tests.hw.franka.fci.server.server_bench import HOST
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.scripted_arm import ScriptedArm


def simulated():
    description = load_robot_files("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)]).arms["panda"]


def driven(network):
    """Return the driver, joined to our server with a simulated arm behind it."""
    description = load_robot_files("example-robot-data:panda")
    return FciArm(network, lambda: ArmModel(description), is_enforced=False)


ARMS = {
    "simulated": simulated,
    "scripted": ScriptedArm,
    "fci": lambda: driven(SteppedNetwork(simulated())),
    "fci over sockets": lambda: driven(PumpedNetwork(simulated(), HOST)),
}


class TestEveryArm(ArmConformance):
    """The suite, over the arms."""

    @pytest.fixture(params=ARMS)
    def arm(self, request):
        arm = ARMS[request.param]()
        yield arm
        if isinstance(arm, FciArm):
            arm.close()
