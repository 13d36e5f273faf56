"""The actions and the findings of a storm."""

from collections import Counter
from dataclasses import dataclass

from typing_extensions import override


@dataclass(frozen=True)
class StormReport:
    """The actions and the findings of a storm.

    Attributes:
        seed: With which it can be repeated; the order of the threads is not.
        threads: How many threads there were.
        operations: How often each operation was carried out, by name.
        refusals: How often an operation was refused, by the code of the error.
        switches: How the switches ended that were not refused, by outcome.
        mischiefs: How often a controller did something wrong.
        cycles: How many cycles the observer has looked at.
        duration: How long the storm took [s wall time].
        problems: What was wrong; empty when nothing was.
    """

    seed: int
    threads: int
    operations: Counter[str]
    refusals: Counter[str]
    switches: Counter[str]
    mischiefs: int
    cycles: int
    duration: float
    problems: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Return whether nothing was wrong."""
        return not self.problems

    @override
    def __str__(self) -> str:
        """Return the report as a few lines of text."""
        lines = [
            f"storm of {self.operations.total()} operations by {self.threads} threads, "
            f"seed {self.seed}: {self.duration:.1f} s, {self.cycles} cycles, "
            f"{self.mischiefs} mischiefs",
            f"operations: {_listed(self.operations)}",
            f"refusals: {_listed(self.refusals)}",
            f"switches: {_listed(self.switches)}",
            *(f"PROBLEM {problem}" for problem in self.problems),
            "nothing was wrong" if self.ok else f"{len(self.problems)} problems",
        ]
        return "\n".join(lines)


def _listed(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.most_common())
