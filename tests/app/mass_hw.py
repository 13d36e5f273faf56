"""A robot for tests: one joint that moves as it is commanded, without simulator."""

from typing_extensions import override

from station.core.hardware.interfaces import (
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters

TYPE = f"{__name__}:MassHW"
BROKEN_TYPE = f"{__name__}:BrokenHW"


class MassHW(RobotHW):
    """One joint, `joint1`, that is where it is commanded to be."""

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Register the joint; `start` is its first position [rad]."""
        self.position = [hw_params.get_float("start", 0.0)]
        self.velocity, self.effort = [0.0], [0.0]
        self.command = list(self.position)
        state = JointStateHandle("joint1", self.position, self.velocity, self.effort)
        states, commands = JointStateInterface(), PositionJointInterface()
        states.register_handle(state)
        commands.register_handle(JointHandle(state, self.command))
        self.register_interface(states)
        self.register_interface(commands)

    @override
    def write(self, time: float, period: float) -> None:
        self.position[0] = self.command[0]


class BrokenHW(MassHW):
    """Cannot be written after half a second."""

    @override
    def write(self, time: float, period: float) -> None:
        if time > 0.5:
            raise OSError("the cable is out")
