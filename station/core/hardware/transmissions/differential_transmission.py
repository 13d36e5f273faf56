"""Two actuators drive two joints through a differential, as in many wrists.

With actuator reductions a1, a2, joint reductions j1, j2 and offsets o1, o2:

| quantity            | first joint                        | second joint            |
|---------------------|------------------------------------|-------------------------|
| effort, torque      | `j1 * (F1*a1 + F2*a2)`             | `j2 * (F1*a1 - F2*a2)`  |
| velocity            | `(V1/a1 + V2/a2) / (2*j1)`         | `(V1/a1 - V2/a2)/(2*j2)`|
| position, absolute  | as velocity, plus o1               | as velocity, plus o2    |

| quantity            | first actuator                     | second actuator         |
|---------------------|------------------------------------|-------------------------|
| effort              | `(F1/j1 + F2/j2) / (2*a1)`         | `(F1/j1 - F2/j2)/(2*a2)`|
| velocity            | `(V1*j1 + V2*j2) * a1`             | `(V1*j1 - V2*j2) * a2`  |
| position            | as velocity, with `x - o` for V    | the same                |

If the absolute encoders sit on the joints, the transmission is ignored for them. The
first joint's encoder is then the second one in the order of the actuators.

Source: ros_control@633c374 differential_transmission.h, DifferentialTransmission.
"""

from collections.abc import Sequence

from typing_extensions import override

from station.core.hardware.transmissions.two_by_two_transmission import (
    TwoByTwoTransmission,
)


class DifferentialTransmission(TwoByTwoTransmission):
    """Add and subtract the motions of two actuators.

    Attributes:
        ignore_transmission_for_absolute_encoders: Whether the absolute encoders sit on
            the joints.
    """

    kind = "differential"

    def __init__(
        self,
        actuator_reduction: Sequence[float],
        joint_reduction: Sequence[float],
        joint_offset: Sequence[float] = (0.0, 0.0),
        *,
        ignore_transmission_for_absolute_encoders: bool = False,
    ) -> None:
        """Check and store the parameters.

        Args:
            actuator_reduction: See `TwoByTwoTransmission`.
            joint_reduction: See `TwoByTwoTransmission`.
            joint_offset: See `TwoByTwoTransmission`.
            ignore_transmission_for_absolute_encoders: Whether the absolute encoders
                sit on the joints.
        """
        super().__init__(actuator_reduction, joint_reduction, joint_offset)
        self.ignore_transmission_for_absolute_encoders: bool = (
            ignore_transmission_for_absolute_encoders
        )

    @override
    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [
            j[0] * (effort[0] * a[0] + effort[1] * a[1]),
            j[1] * (effort[0] * a[0] - effort[1] * a[1]),
        ]

    @override
    def actuator_to_joint_velocity(self, velocity: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [
            (velocity[0] / a[0] + velocity[1] / a[1]) / (2.0 * j[0]),
            (velocity[0] / a[0] - velocity[1] / a[1]) / (2.0 * j[1]),
        ]

    @override
    def actuator_to_joint_absolute_position(self, position: list[float]) -> list[float]:
        if self.ignore_transmission_for_absolute_encoders:
            return [position[1], position[0]]
        return self.actuator_to_joint_position(position)

    @override
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [
            (effort[0] / j[0] + effort[1] / j[1]) / (2.0 * a[0]),
            (effort[0] / j[0] - effort[1] / j[1]) / (2.0 * a[1]),
        ]

    @override
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [
            (velocity[0] * j[0] + velocity[1] * j[1]) * a[0],
            (velocity[0] * j[0] - velocity[1] * j[1]) * a[1],
        ]
