"""Takes commands for a simulated arm without a call of Python."""

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.receiver import Receiver
from station.hw.franka.simulated import step_codes as codes
from station.hw.franka.simulated.arm_step import ArmStep
from station.memory.doubles import Doubles, Storage

# As C numbers, by the .pxd.
_POSITIONS = codes.POSITIONS
_VELOCITIES = codes.VELOCITIES
_CARTESIAN = codes.CARTESIAN
_POSE = 16


class StepReceiver(Receiver):
    """Takes the commands of the motion that runs, if they are finite numbers.

    Args:
        step: The arm's arithmetic.
        memory: The memory of the arm's joints.
    """

    def __init__(self, step: ArmStep, memory: JointMemory) -> None:
        self.step = step
        self.memory = memory

    def receive_torques(self, tau: Storage) -> bool:
        """Return whether torques were taken."""
        step, memory = self.step, self.memory
        return step.wants_torques and step.receive(tau, memory.size, memory.torques)

    def receive_positions(self, q: Storage) -> bool:
        """Return whether positions were taken."""
        return self.receive_target(q, _POSITIONS)

    def receive_velocities(self, dq: Storage) -> bool:
        """Return whether velocities were taken."""
        return self.receive_target(dq, _VELOCITIES)

    def receive_target(self, values: Storage, generator: int) -> bool:
        """Return whether positions or velocities were taken.

        Args:
            values: The command, shape (7,).
            generator: The motion that takes them, see `step_codes`.
        """
        step, memory = self.step, self.memory
        if step.generator != generator:
            return False
        return step.receive(values, memory.size, memory.target)

    def receive_pose(self, pose: Doubles) -> bool:
        """Return whether a pose was taken."""
        step = self.step
        return step.generator == _CARTESIAN and step.receive_end_effector(pose, _POSE)

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return self.step.cartesian.is_settled
