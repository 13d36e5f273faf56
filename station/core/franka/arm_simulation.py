"""The operations that only a simulated arm offers: buttons, pushes and faults.

No real arm offers these operations to a program: people press the user stop and the
guiding buttons, and nobody can order a sensor to fail.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from station.core.hardware.robot_report import ClampReport


class FaultKind(Enum):
    """The kinds of faults that can be injected into a simulation."""

    LOST_PACKETS = "lost_packets"
    """Commands do not reach the arm."""
    DELAYED_CYCLE = "delayed_cycle"
    """The loop's next cycle begins late: its period is longer, packets are lost."""
    NAN_SENSOR = "nan_sensor"
    """The measured position of a joint is not finite."""
    STUCK_JOINT = "stuck_joint"
    """A joint does not move."""
    COLLISION = "collision"
    """Something hits the hand."""


@dataclass(frozen=True, slots=True)
class SimulatedFault:
    """One fault to inject.

    Attributes:
        kind: Kind of the fault.
        cycles: Duration in cycles of the arm, >= 1.
        joint: Number of the joint, 1 to 7; ignored by kinds that concern no joint.
        force: Force of a collision in the base frame [N], shape (3,).
    """

    kind: FaultKind
    cycles: int
    joint: int = 1
    force: tuple[float, float, float] = (0.0, 0.0, -100.0)


class ArmSimulation(ABC):
    """The controls of one simulated arm. Control thread, between two cycles."""

    @abstractmethod
    def set_user_stop(self, *, pressed: bool) -> None:
        """Press or release the user stop; releasing it clears the arm's errors.

        Args:
            pressed: Whether the button is down from now on.
        """

    @abstractmethod
    def set_guiding(self, *, pressed: bool) -> None:
        """Press or release the guiding buttons; pressed, the arm gives way to pushes.

        Args:
            pressed: Whether the buttons are down from now on.

        Raises:
            ArmCommandError: The buttons are to be pressed and the arm is not idle.
        """

    @abstractmethod
    def apply_force(
        self,
        link: str,
        force: Sequence[float],
        torque: Sequence[float],
        duration: float,
        *,
        frame: str = "world",
        point: Sequence[float] | None = None,
    ) -> None:
        """Push a link of the arm, or another object of its world, for a while.

        Args:
            link: Name of the link or object.
            force: Force [N], shape (3,).
            torque: Torque [Nm], shape (3,).
            duration: Duration of the push [s], > 0.
            frame: Axes of `force` and `torque`: `world`, or the name of a link, with
                which they turn.
            point: Where the force acts, in the link's frame [m], shape (3,); None for
                the link's centre of mass.

        Raises:
            HardwareInterfaceError: The world has no such link or object.
        """

    @abstractmethod
    def inject(self, fault: SimulatedFault) -> None:
        """Begin a fault; a running fault of the same kind and joint is replaced.

        The arm does nothing about a delayed cycle, which the control loop carries out.

        Args:
            fault: The fault.

        Raises:
            InvalidCommandError: The fault lasts too long.
            HardwareInterfaceError: The arm has nothing that a collision could hit.
        """

    @abstractmethod
    def faults(self) -> list[SimulatedFault]:
        """Return the active faults with their remaining cycles."""

    @abstractmethod
    def clear_faults(self) -> None:
        """End all faults and all pushes."""

    @abstractmethod
    def clamps(self) -> list[ClampReport]:
        """Return the joints that the simulation's own brakes have held. Any thread."""
