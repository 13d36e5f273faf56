"""Every arm behind the seam conforms; another driver joins by a line in `ARMS`."""

from functools import partial

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.wire.robot_protocol import FR3, PANDA
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.testing import ArmConformance
from tests.hw.franka.fci.pumped_network import PumpedNetwork
from tests.hw.franka.fci.server.server_bench import HOST
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.scripted_arm import ScriptedArm


def simulated(limits=PANDA_LIMITS):
    description = load_robot_files("example-robot-data:panda")
    placement = ArmPlacement("panda", description, limits=limits)
    return simulate([placement]).arms["panda"]


def driven(network, protocol=PANDA):
    """Return the driver, joined to our server with a simulated arm behind it."""
    description = load_robot_files("example-robot-data:panda")
    model = partial(ArmModel, description)
    return FciArm(network, model, is_enforced=False, protocol=protocol)


ARMS = {
    "simulated": simulated,
    "scripted": ScriptedArm,
    "fci": lambda: driven(SteppedNetwork(simulated())),
    "fci of an FR3": lambda: driven(
        SteppedNetwork(simulated(FR3_LIMITS), FR3[-1]), FR3[-1]
    ),
    "fci over sockets": lambda: driven(PumpedNetwork(simulated(), HOST)),
}


class TestEveryArm(ArmConformance):
    """The suite, over the arms."""

    @pytest.fixture(params=ARMS)
    def name(self, request):
        return request.param

    @pytest.fixture
    def resolution(self, name):
        # An FR3 tells its state in single precision: 1.2e-7 of angles up to 3 rad.
        return 3e-7 if name == "fci of an FR3" else 1e-12

    @pytest.fixture
    def arm(self, name):
        arm = ARMS[name]()
        yield arm
        if isinstance(arm, FciArm):
            arm.close()
