"""Connect to the arm that the parameters of FrankaHW name, and to its hand."""

from functools import partial

from station.core.errors import StationError
from station.core.franka.franka_model import FrankaModel
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.hand_link import HandLink
from station.hw.franka.fci.driver.network import FciNetwork
from station.hw.franka.fci.driver.real_hand import RealHand
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import PANDA
from station.hw.franka.franka_parameters import FrankaParameters


def connect(parameters: FrankaParameters) -> FciArm:
    """Return the arm at `robot_ip`, with the configured collision behaviour.

    Args:
        parameters: The parameters, with a `robot_ip`.

    Raises:
        RobotDescriptionError: The URDF cannot be used for the model.
        FciNetworkError: The arm does not answer.
        FciProtocolError: The arm speaks another version.
        StationError: The arm refuses its settings, or is lost at once.
    """
    description = load_arm_description(parameters.robot_description, parameters.limits)

    def make_model() -> FrankaModel:
        # Imported here: it loads MuJoCo, whose formulas combine the inertias of links.
        from station.hw.franka.simulated.arm_model import ArmModel

        return ArmModel(description)

    def open_network() -> FciNetwork:
        return FciNetwork(parameters.robot_ip or "", PANDA.port)

    arm = FciArm(
        open_network(),
        make_model,
        is_enforced=not parameters.waits_for_late_loop,
        reopen=open_network,
    )
    try:
        arm.set_collision_behavior(parameters.collision_behavior)
    except StationError:
        arm.close()
        raise
    return arm


def connect_hand(parameters: FrankaParameters) -> RealHand:
    """Return the hand at `robot_ip`, which is connected to as soon as it answers.

    Args:
        parameters: The parameters, with a `robot_ip`.
    """
    link = HandLink(partial(FciNetwork, parameters.robot_ip or "", HAND.port))
    hand = RealHand(parameters.arm_id, link)
    link.start()
    return hand
