"""One actuator drives one joint through a reduction.

With reduction n and offset o:

| quantity                    | joint from actuator | actuator from joint |
|-----------------------------|---------------------|---------------------|
| effort, torque sensor       | `F_a * n`           | `F_j / n`           |
| velocity                    | `V_a / n`           | `V_j * n`           |
| position, absolute position | `x_a / n + o`       | `(x_j - o) * n`     |

Source: ros_control@633c374 simple_transmission.h, SimpleTransmission.
"""

from typing_extensions import override

from station.core.hardware.transmissions.transmission import (
    Transmission,
    TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_maps import (
    NO_OFFSET,
    divided,
    multiplied,
)


class SimpleTransmission(Transmission):
    """Reduce speed and multiply effort by a constant factor.

    Attributes:
        reduction: Actuator turns per joint turn, not 0; negative turns the other way.
        joint_offset: Joint position at actuator position 0 [rad or m].
    """

    def __init__(self, reduction: float, joint_offset: float = 0.0) -> None:
        """Store the parameters.

        Args:
            reduction: Actuator turns per joint turn, not 0.
            joint_offset: Joint position at actuator position 0 [rad or m].

        Raises:
            TransmissionInterfaceError: `reduction` is 0.
        """
        if reduction == 0.0:
            raise TransmissionInterfaceError(
                "Transmission reduction ratio cannot be zero.",
                remedy="Correct the actuator's <mechanicalReduction>.",
            )
        self.reduction: float = reduction
        self.joint_offset: float = joint_offset

    @override
    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        return [multiplied(effort[0], self.reduction, 0.0)]

    @override
    def actuator_to_joint_velocity(self, velocity: list[float]) -> list[float]:
        return [divided(velocity[0], self.reduction, NO_OFFSET)]

    @override
    def actuator_to_joint_position(self, position: list[float]) -> list[float]:
        return [divided(position[0], self.reduction, self.joint_offset)]

    @override
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        return [divided(effort[0], self.reduction, NO_OFFSET)]

    @override
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        return [multiplied(velocity[0], self.reduction, 0.0)]

    @override
    def joint_to_actuator_position(self, position: list[float]) -> list[float]:
        return [multiplied(position[0], self.reduction, self.joint_offset)]
