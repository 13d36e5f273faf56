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

from typing_extensions import override

from station.core.hardware.transmissions.two_by_two_transmission import (
    TwoByTwoTransmission,
)


class FourBarLinkageTransmission(TwoByTwoTransmission):
    """Move the second joint by the second actuator relative to the first joint."""

    kind = "four-bar linkage"

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
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [effort[0] / (a[0] * j[0]), (effort[0] + effort[1] / j[1]) / a[1]]

    @override
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        a, j = self.actuator_reduction, self.joint_reduction
        return [velocity[0] * j[0] * a[0], (velocity[0] + velocity[1] * j[1]) * a[1]]
