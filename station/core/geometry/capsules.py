"""Capsules that enclose the links of a robot."""

from dataclasses import dataclass

from station.core.description.urdf import Vector3


@dataclass(frozen=True, slots=True)
class LinkCapsule:
    """A capsule that is fixed to a link.

    Attributes:
        link: Name of the link.
        first: One end of the axis in the frame of the link [m].
        second: The other end [m].
        radius: Radius [m], > 0.
    """

    link: str
    first: Vector3
    second: Vector3
    radius: float

    def numbers(self) -> list[float]:
        """Return the ends [m] and the radius [m], 7 numbers."""
        return [*self.first, *self.second, self.radius]
