"""Takes commands for a simulated arm without a call of Python."""

from collections.abc import Callable

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm import arm_codes as codes
from station.hw.franka.arm.receiver import PoseReceiver, Receiver
from station.hw.franka.simulated.arm_step import ArmStep
from station.memory.doubles import Doubles, Storage

# As a C number, by the .pxd.
_CARTESIAN = codes.CARTESIAN
_POSE = 16


class TorqueReceiver(Receiver):
    """Takes torques for a simulated arm.

    Args:
        function: Takes what the step does not take, or refuses it.
        step: The arm's arithmetic.
        memory: The memory of the arm's joints.
    """

    def __init__(
        self, function: Callable[[Storage], object], step: ArmStep, memory: JointMemory
    ) -> None:
        super().__init__(function)
        self.step = step
        self.size = memory.size
        self.place = memory.torques

    def receive(self, values: Storage) -> None:
        """Take torques [Nm], shape (7,)."""
        step = self.step
        if not step.wants_torques or not step.receive(values, self.size, self.place):
            self.function(values)


class JointReceiver(Receiver):
    """Takes positions or velocities for a simulated arm.

    Args:
        function: Takes what the step does not take, or refuses it.
        step: The arm's arithmetic.
        memory: The memory of the arm's joints.
        generator: What the step's motion has to command, see `arm_codes`.
    """

    def __init__(
        self,
        function: Callable[[Storage], object],
        step: ArmStep,
        memory: JointMemory,
        generator: int,
    ) -> None:
        super().__init__(function)
        self.step = step
        self.size = memory.size
        self.place = memory.target
        self.generator = generator

    def receive(self, values: Storage) -> None:
        """Take positions [rad] or velocities [rad/s], shape (7,)."""
        step = self.step
        if step.generator != self.generator or not step.receive(
            values, self.size, self.place
        ):
            self.function(values)


class EndEffectorReceiver(PoseReceiver):
    """Takes poses for a simulated arm.

    Args:
        step: The arm's arithmetic.
    """

    def __init__(self, step: ArmStep) -> None:
        self.step = step

    def is_open(self) -> bool:
        """Return whether the motion that runs commands the end effector."""
        return self.step.generator == _CARTESIAN

    def is_settled(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return self.step.cartesian.is_settled

    def receive(self, pose: Doubles) -> bool:
        """Take a pose without an elbow for the next cycle."""
        return self.step.receive_end_effector(pose, _POSE)
