"""A change that makes a robot description usable, and its words."""

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
]


@dataclass(frozen=True, slots=True)
class Repair:
    """One thing in which the simulated robot differs from its description.

    Attributes:
        kind: What was changed.
        element: The element of the description, e.g. `link 'wrist'`.
        problem: What is wrong with it, without a full stop.
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
        """Return whether nothing is wrong: a URDF cannot state what was added."""
        return self.kind in {"armature", "gravity"}

    def sentence(self) -> str:
        """Return the repair in one line."""
        was = f" (was {self.old})" if self.old else ""
        return f"{self.element}: {self.problem}; now {self.new}{was}"
