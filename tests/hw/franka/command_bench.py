"""A FrankaHW without a manager: commands go straight to its interfaces."""

from station.core.franka import (
    FrankaPoseCartesianInterface,
    FrankaServices,
    FrankaServicesInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.hw.franka.franka_hw import FrankaHW
from tests.hw.franka.test_franka_hw import JOINTS


class Bench:
    """A FrankaHW that passes commands on as they are, and what commands it."""

    def __init__(self, hw: FrankaHW) -> None:
        self.hw = hw
        self.state = hw.robot_state
        services = hw.get(FrankaServicesInterface)
        assert services is not None
        self.services: FrankaServices = services.get_handle("panda")

    def start(self, kind: str) -> None:
        """Switch to a mode: jt, jp, jv, cp or cv."""
        names = {
            "jt": ("hardware_interface::EffortJointInterface", JOINTS),
            "jp": ("hardware_interface::PositionJointInterface", JOINTS),
            "jv": ("hardware_interface::VelocityJointInterface", JOINTS),
            "cp": (FrankaPoseCartesianInterface.type_name, ("panda_robot",)),
            "cv": (FrankaVelocityCartesianInterface.type_name, ("panda_robot",)),
        }
        claims = InterfaceResources(*names[kind])
        self.controller = ControllerInfo("c", "test/C", (claims,))
        self.hw.prepare_switch([self.controller], [])
        self.hw.do_switch([self.controller], [])

    def pose(self) -> list[float]:
        """Return the desired pose."""
        self.hw.arm.refresh_state()
        return list(self.state.O_T_EE_d)

    def command_pose(self, pose: list[float], elbow: list[float] | None = None) -> None:
        handle = self._cartesian(FrankaPoseCartesianInterface)
        handle.set_command(pose, elbow) if elbow else handle.set_command(pose)

    def command_twist(
        self, twist: list[float], elbow: list[float] | None = None
    ) -> None:
        handle = self._cartesian(FrankaVelocityCartesianInterface)
        handle.set_command(twist, elbow) if elbow else handle.set_command(twist)

    def _cartesian(self, interface):
        return self.hw.get(interface).get_handle("panda_robot")
