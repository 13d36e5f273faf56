"""Two actuators drive two joints through a four-bar linkage, as in many legs.

With actuator reductions a1, a2, joint reductions j1, j2 and offsets o1, o2:

| quantity            | first joint         | second joint                           |
|---------------------|---------------------|----------------------------------------|
| effort, torque      | `j1 * (F1*a1)`      | `j2 * (F2*a2 - F1*a1*j1)`              |
| velocity            | `V1 / (j1*a1)`      | `(V2/a2 - V1/(j1*a1)) / j2`            |
| position, absolute  | as velocity, + o1   | as velocity, + o2                      |

| quantity            | first actuator      | second actuator                        |
|---------------------|---------------------|----------------------------------------|
| effort              | `F1 / (a1*j1)`      | `(F1 + F2/j2) / a2`                    |
| velocity            | `V1 * j1 * a1`      | `(V1 + V2*j2) * a2`                    |
| position            | as velocity, with `x - o` for V                              |

The maps are each other's inverses. They do not preserve power, in the original either:
its effort map is not the transpose of its velocity map, and the joints' power exceeds
the actuators' by `F1*V1 - F2*V1*a2/(j1*a1) - F1*V2*j1*a1/a2`.

Source: ros_control@633c374 four_bar_linkage_transmission.h, FourBarLinkageTransmission.
"""

from collections.abc import Sequence

from typing_extensions import override

from station.core.hardware.transmissions.transmission import (
    Transmission,
    check_two_by_two,
)


class FourBarLinkageTransmission(Transmission):
    """Let the second joint's motion be what the second actuator does beyond the first.

    Attributes:
        actuator_reduction: Reductions on the actuator side, shape (2,).
        joint_reduction: Reductions on the joint side, shape (2,).
        joint_offset: Joint positions at actuator positions 0 [rad or m], shape (2,).
    """

    num_actuators = 2
    num_joints = 2

    def __init__(
        self,
        actuator_reduction: Sequence[float],
        joint_reduction: Sequence[float],
        joint_offset: Sequence[float] = (0.0, 0.0),
    ) -> None:
        """Store the parameters.

        Args:
            actuator_reduction: Reductions on the actuator side, shape (2,), not 0.
            joint_reduction: Reductions on the joint side, shape (2,), not 0.
            joint_offset: Joint positions at actuator positions 0 [rad or m], shape
                (2,).

        Raises:
            TransmissionInterfaceError: A list has not two values, or a reduction is 0.
        """
        check_two_by_two(
            "four-bar linkage", actuator_reduction, joint_reduction, joint_offset
        )
        self.actuator_reduction: list[float] = list(actuator_reduction)
        self.joint_reduction: list[float] = list(joint_reduction)
        self.joint_offset: list[float] = list(joint_offset)

    @override
    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [
            j[0] * (effort[0] * a[0]),
            j[1] * (effort[1] * a[1] - effort[0] * a[0] * j[0]),
        ]

    @override
    def actuator_to_joint_velocity(self, velocity: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        first = velocity[0] / (j[0] * a[0])
        return [first, (velocity[1] / a[1] - first) / j[1]]

    @override
    def actuator_to_joint_position(self, position: list[float]) -> list[float]:
        joint = self.actuator_to_joint_velocity(position)
        return [joint[0] + self.joint_offset[0], joint[1] + self.joint_offset[1]]

    @override
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [effort[0] / (a[0] * j[0]), (effort[0] + effort[1] / j[1]) / a[1]]

    @override
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [velocity[0] * j[0] * a[0], (velocity[0] + velocity[1] * j[1]) * a[1]]

    @override
    def joint_to_actuator_position(self, position: list[float]) -> list[float]:
        o = self.joint_offset
        return self.joint_to_actuator_velocity([position[0] - o[0], position[1] - o[1]])
