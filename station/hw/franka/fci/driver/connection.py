"""Connect to the arm that the parameters of FrankaHW name, and to its hand."""

from collections.abc import Iterable, Sequence
from functools import partial

from station.core.errors import StationError
from station.core.franka import GripperServicesInterface
from station.core.franka.franka_model import FrankaModel
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.fci_client import IncompatibleVersionError
from station.hw.franka.fci.driver.hand_link import HandLink
from station.hw.franka.fci.driver.network import FciNetwork
from station.hw.franka.fci.driver.real_hand import RealHand
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import (
    RobotProtocol,
    versions_of_arm,
)
from station.hw.franka.franka_parameters import FrankaParameters


class RealRobot:
    """The arm at `robot_ip`, with the configured collision behaviour, and its hand.

    Args:
        parameters: The parameters, with a `robot_ip`.

    Attributes:
        arm: The arm.

    Raises:
        RobotDescriptionError: The URDF cannot be used for the model.
        FciNetworkError: The arm does not answer.
        FciProtocolError: The arm speaks another version.
        StationError: The arm refuses its settings, or is lost at once.
    """

    def __init__(self, parameters: FrankaParameters) -> None:
        self._parameters = parameters
        self._hand: RealHand | None = None
        told = parameters.robot_description
        self._description = load_arm_description(told, parameters.limits)
        self.arm = self._connect()
        try:
            self.arm.set_collision_behavior(parameters.collision_behavior)
        except StationError:
            self.arm.close()
            raise

    def add_hand(
        self, names: Sequence[str], interfaces: Iterable[object]
    ) -> GripperServicesInterface:
        """Connect to the hand, as soon as it answers; return its services.

        Args:
            names: Names of the two finger joints.
            interfaces: The interfaces of the arm, whose joint states get the fingers if
                the parameters say so.
        """
        link = HandLink(partial(self._open, HAND.port))
        self._hand = RealHand(self._parameters.arm_id, link)
        if self._parameters.publishes_fingers:
            self._hand.register(interfaces, names)
        link.start()
        services = GripperServicesInterface()
        services.register_handle(self._hand)
        return services

    def close(self) -> None:
        """Stop the motion, and close the connection."""
        if self._hand is not None:
            self._hand.close()
        self.arm.close()

    def _make_model(self) -> FrankaModel:
        # Imported here: it loads MuJoCo, whose formulas combine inertias of links.
        from station.hw.franka.simulated.arm_model import ArmModel

        return ArmModel(self._description)

    def _connect(self) -> FciArm:
        """Connect with the newest version of this kind of arm, or with the arm's own.

        The system of a real arm speaks one version, and names it when a client asks for
        another one.

        Raises:
            FciNetworkError: The arm does not answer.
            FciProtocolError: The arm's answer does not follow the protocol.
            IncompatibleVersionError: The arm speaks no version of this kind of arm.
        """
        spoken = versions_of_arm(self._parameters.arm)
        try:
            return self._connect_with(spoken[-1])
        except IncompatibleVersionError as error:
            named = [one for one in spoken if one.version == error.server_version]
            if not named:
                raise
        return self._connect_with(named[0])

    def _connect_with(self, protocol: RobotProtocol) -> FciArm:
        return FciArm(
            self._open(protocol.port),
            self._make_model,
            is_enforced=not self._parameters.waits_for_late_loop,
            protocol=protocol,
            reopen=partial(self._open, protocol.port),
        )

    def _open(self, port: int) -> FciNetwork:
        return FciNetwork(self._parameters.robot_ip or "", port)
