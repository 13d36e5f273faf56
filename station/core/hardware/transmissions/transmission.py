"""Map between actuator space and joint space.

A transmission is simple, a differential or a four-bar linkage; users may add others.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from typing_extensions import override

from station.core.errors import HardwareInterfaceError
from station.core.hardware.transmissions.transmission_maps import (
    NO_OFFSET,
    divided,
    multiplied,
)


class TransmissionInterfaceError(HardwareInterfaceError, ValueError):
    """A transmission cannot be described, built or connected.

    Source:
        ros_control@633c374 transmission_interface_exception.h,
        TransmissionInterfaceException; differs: the message also has a remedy.
    """

    code = "transmission_interface"


class Transmission(ABC):
    """Map positions, velocities and efforts of some actuators to those of some joints.

    Contract: the maps are pure functions. They take one value per actuator (or joint)
    in a fixed order and return a new list with one value per joint (or actuator). The
    maps of a quantity in both directions are inverse to each other. An ideal
    transmission preserves power: the sum of the products of effort and velocity is
    equal on both sides. The control thread calls the maps every cycle.

    Absolute encoders and torque sensors sit on the actuator side. By default they are
    mapped like position and effort.

    Attributes:
        num_actuators: Dimension of the actuator space.
        num_joints: Dimension of the joint space.

    Source:
        ros_control@633c374 transmission.h, Transmission; differs: maps return values
        and leave pointers to the handles, and absolute position and torque sensor have
        a default.
    """

    num_actuators: int = 1
    num_joints: int = 1

    @abstractmethod
    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        """Return joint efforts [N*m or N] for actuator efforts [N*m or N]."""

    @abstractmethod
    def actuator_to_joint_velocity(self, velocity: list[float]) -> list[float]:
        """Return joint velocities [rad/s or m/s] for actuator velocities."""

    @abstractmethod
    def actuator_to_joint_position(self, position: list[float]) -> list[float]:
        """Return joint positions [rad or m] for actuator positions."""

    def actuator_to_joint_absolute_position(self, position: list[float]) -> list[float]:
        """Return joint positions [rad or m] for actuator-side absolute encoders."""
        return self.actuator_to_joint_position(position)

    def actuator_to_joint_torque_sensor(self, effort: list[float]) -> list[float]:
        """Return joint efforts [N*m or N] for actuator-side torque sensors."""
        return self.actuator_to_joint_effort(effort)

    @abstractmethod
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        """Return actuator efforts [N*m or N] for joint efforts [N*m or N]."""

    @abstractmethod
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        """Return actuator velocities [rad/s or m/s] for joint velocities."""

    @abstractmethod
    def joint_to_actuator_position(self, position: list[float]) -> list[float]:
        """Return actuator positions [rad or m] for joint positions."""


class SimpleTransmission(Transmission):
    """Reduce speed and multiply effort by a constant factor.

    With reduction n and offset o:

    | quantity                    | joint from actuator | actuator from joint |
    |-----------------------------|---------------------|---------------------|
    | effort, torque sensor       | `F_a * n`           | `F_j / n`           |
    | velocity                    | `V_a / n`           | `V_j * n`           |
    | position, absolute position | `x_a / n + o`       | `(x_j - o) * n`     |

    Attributes:
        reduction: Actuator turns per joint turn, not 0; negative turns the other way.
        joint_offset: Joint position at actuator position 0 [rad or m].

    Source:
        ros_control@633c374 simple_transmission.h, SimpleTransmission.
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


class TwoByTwoTransmission(Transmission):
    """Map two actuators to two joints by reductions and offsets.

    Positions are mapped like velocities; then the joint offsets are added.

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
            TransmissionInterfaceError: A list does not have two values, or a reduction
                is 0.
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


class DifferentialTransmission(TwoByTwoTransmission):
    """Add and subtract the motions of two actuators.

    With actuator reductions a1, a2, joint reductions j1, j2 and offsets o1, o2:

    | quantity           | first joint                       | second joint            |
    |--------------------|-----------------------------------|-------------------------|
    | effort, torque     | `j1 * (F1*a1 + F2*a2)`            | `j2 * (F1*a1 - F2*a2)`  |
    | velocity           | `(V1/a1 + V2/a2) / (2*j1)`        | `(V1/a1 - V2/a2)/(2*j2)`|
    | position, absolute | as velocity, plus o1              | as velocity, plus o2    |

    | quantity           | first actuator                    | second actuator         |
    |--------------------|-----------------------------------|-------------------------|
    | effort             | `(F1/j1 + F2/j2) / (2*a1)`        | `(F1/j1 - F2/j2)/(2*a2)`|
    | velocity           | `(V1*j1 + V2*j2) * a1`            | `(V1*j1 - V2*j2) * a2`  |
    | position           | as velocity, with `x - o` for V   | the same                |

    If the absolute encoders sit on the joints, their values bypass the transmission.
    The first joint's encoder is then the second one in the order of the actuators.

    Attributes:
        ignore_transmission_for_absolute_encoders: Whether the absolute encoders sit on
            the joints.

    Source:
        ros_control@633c374 differential_transmission.h, DifferentialTransmission.
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


class FourBarLinkageTransmission(TwoByTwoTransmission):
    """Move the second joint by the second actuator relative to the first joint.

    With actuator reductions a1, a2, joint reductions j1, j2 and offsets o1, o2:

    | quantity           | first joint        | second joint                           |
    |--------------------|--------------------|----------------------------------------|
    | effort, torque     | `j1 * (F1*a1)`     | `j2 * (F2*a2 - F1*a1*j1)`              |
    | velocity           | `V1 / (j1*a1)`     | `(V2/a2 - V1/(j1*a1)) / j2`            |
    | position, absolute | as velocity, + o1  | as velocity, + o2                      |

    | quantity           | first actuator     | second actuator                        |
    |--------------------|--------------------|----------------------------------------|
    | effort             | `F1 / (a1*j1)`     | `(F1 + F2/j2) / a2`                    |
    | velocity           | `V1 * j1 * a1`     | `(V1 + V2*j2) * a2`                    |
    | position           | as velocity, with `x - o` for V                             |

    The maps are each other's inverses. As in the original, they do not preserve power:
    the effort map is not the transpose of the velocity map, and the joints' power
    exceeds the actuators' by `F1*V1 - F2*V1*a2/(j1*a1) - F1*V2*j1*a1/a2`.

    Source:
        ros_control@633c374 four_bar_linkage_transmission.h, FourBarLinkageTransmission.
    """

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
