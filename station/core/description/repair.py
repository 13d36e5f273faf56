"""A change that makes a robot description usable, and the sentence that reports it."""

from dataclasses import dataclass
from typing import Literal

RepairKind = Literal[
    "inertia",
    "mass",
    "range",
    "mimic",
    "motor",
    "friction",
    "transmission",
    "self_collision",
    "start_pose",
    "base",
    "name",
    "armature",
    "gravity",
    "ros2_control",
]


@dataclass(frozen=True, slots=True)
class Repair:
    """One difference between the simulated robot and its description.

    Attributes:
        kind: Kind of the changed element.
        element: The element of the description, e.g. `link 'wrist'`.
        problem: Fault of the element, without a full stop.
        old: The value in the description; empty if there is none.
        new: The value that is used instead.
    """

    kind: RepairKind
    element: str
    problem: str
    old: str
    new: str

    @property
    def is_addition(self) -> bool:
        """Return whether the repair adds an element that a URDF cannot state."""
        return self.kind in {"armature", "gravity"}

    def sentence(self) -> str:
        """Return the repair in one line."""
        was = f" (was {self.old})" if self.old else ""
        return f"{self.element}: {self.problem}; now {self.new}{was}"
