"""The common part of all transmissions of two actuators and two joints."""

from collections.abc import Sequence
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.transmissions.transmission import (
    Transmission,
    TransmissionInterfaceError,
)


class TwoByTwoTransmission(Transmission):
    """Map two actuators to two joints by reductions and offsets.

    Positions are mapped like velocities, with the joint offsets added.

    Attributes:
        kind: Name of the transmission in messages.
        actuator_reduction: Reductions on the actuator side, shape (2,).
        joint_reduction: Reductions on the joint side, shape (2,).
        joint_offset: Joint positions at actuator positions 0 [rad or m], shape (2,).
    """

    kind: ClassVar[str]
    num_actuators = 2
    num_joints = 2

    def __init__(
        self,
        actuator_reduction: Sequence[float],
        joint_reduction: Sequence[float],
        joint_offset: Sequence[float] = (0.0, 0.0),
    ) -> None:
        """Check and store the parameters.

        Args:
            actuator_reduction: Reductions on the actuator side, shape (2,), not 0.
            joint_reduction: Reductions on the joint side, shape (2,), not 0.
            joint_offset: Joint positions at actuator positions 0 [rad or m], shape
                (2,).

        Raises:
            TransmissionInterfaceError: A list has not two values, or a reduction is 0.
        """
        sizes = [len(actuator_reduction), len(joint_reduction), len(joint_offset)]
        if sizes != [2, 2, 2]:
            raise TransmissionInterfaceError(
                f"Reduction and offset vectors of a {self.kind} transmission must have "
                "size 2.",
                remedy="Give one value per actuator and per joint; there are "
                f"{sizes[0]} actuator reductions, {sizes[1]} joint reductions and "
                f"{sizes[2]} joint offsets.",
            )
        if 0.0 in [*actuator_reduction, *joint_reduction]:
            raise TransmissionInterfaceError(
                "Transmission reduction ratios cannot be zero.",
                remedy="Correct the <mechanicalReduction> elements: actuators "
                f"{list(actuator_reduction)}, joints {list(joint_reduction)}.",
            )
        self.actuator_reduction: list[float] = list(actuator_reduction)
        self.joint_reduction: list[float] = list(joint_reduction)
        self.joint_offset: list[float] = list(joint_offset)

    @override
    def actuator_to_joint_position(self, position: list[float]) -> list[float]:
        joint = self.actuator_to_joint_velocity(position)
        return [joint[0] + self.joint_offset[0], joint[1] + self.joint_offset[1]]

    @override
    def joint_to_actuator_position(self, position: list[float]) -> list[float]:
        o = self.joint_offset
        return self.joint_to_actuator_velocity([position[0] - o[0], position[1] - o[1]])
