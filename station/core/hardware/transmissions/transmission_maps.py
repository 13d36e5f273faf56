"""Carry one quantity through transmissions that have one actuator and one joint."""

from station.memory.doubles import Doubles, Indices

NO_OFFSET = -0.0
"""Addend of `divided` for quantities without an offset: it changes no number, while 0.0
would turn -0.0 into 0.0."""


def multiplied(value: float, reduction: float, offset: float) -> float:
    """Return a value multiplied by a reduction.

    Args:
        value: The value before the reduction.
        reduction: Actuator turns per joint turn, not 0.
        offset: Number subtracted first; 0 for velocities and efforts.
    """
    return (value - offset) * reduction


def divided(value: float, reduction: float, offset: float) -> float:
    """Return a value divided by a reduction.

    Args:
        value: The value before the reduction.
        reduction: Actuator turns per joint turn, not 0.
        offset: Number added afterwards; `NO_OFFSET` for velocities and efforts.
    """
    return value / reduction + offset


class ReducedValues:
    """Values of n actuators or joints, and the places of the reduced values.

    Args:
        source: Memory of the values.
        target: Receives the values.
        source_places: Index in `source` of each value, shape (n,).
        target_places: Index in `target` of each value, shape (n,).
        reductions: Actuator turns per joint turn, not 0, shape (n,).
        offsets: See `multiplied` and `divided`, shape (n,).
        multiplies: Whether the reductions multiply.
    """

    def __init__(
        self,
        source: Doubles,
        target: Doubles,
        *,
        source_places: Indices,
        target_places: Indices,
        reductions: Doubles,
        offsets: Doubles,
        multiplies: bool,
    ) -> None:
        self.source = source
        self.target = target
        self.source_places = source_places
        self.target_places = target_places
        self.reductions = reductions
        self.offsets = offsets
        self.multiplies = multiplies
        self.size = len(source_places)

    def carry(self) -> None:
        """Write each reduced value to its place."""
        source, target = self.source, self.target
        source_places, target_places = self.source_places, self.target_places
        reductions, offsets = self.reductions, self.offsets
        for i in range(self.size):
            value = source[source_places[i]]
            if self.multiplies:
                value = multiplied(value, reductions[i], offsets[i])
            else:
                value = divided(value, reductions[i], offsets[i])
            target[target_places[i]] = value
