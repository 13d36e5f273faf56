"""Ranges and steps of sliders, wide enough to be useful and fine enough to be set."""

import math
from dataclasses import dataclass

GAIN_REACH = 100.0
"""Right end of the slider of a gain whose value is zero."""
# A continuous joint can be turned by one turn to each side.
_DEFAULT_SPAN = {"rad": 2.0 * math.pi, "m": 1.0, "rad/s": 1.0, "m/s": 0.5, "Nm": 10.0}


@dataclass(frozen=True, slots=True)
class SliderScale:
    """The ends of a slider and the distance between two positions.

    Attributes:
        minimum: Left end.
        maximum: Right end, > minimum.
        step: Distance between two positions of the thumb.
    """

    minimum: float
    maximum: float
    step: float

    def clamp(self, value: float) -> float:
        """Return the nearest value the slider can show."""
        return min(max(value, self.minimum), self.maximum)


def command_scale(
    unit: str, minimum: float | None, maximum: float | None
) -> SliderScale:
    """Return the scale for one element of a set-point.

    Args:
        unit: The element's unit.
        minimum: Smallest value allowed; None where unlimited.
        maximum: Largest value allowed; None where unlimited.
    """
    span = _DEFAULT_SPAN.get(unit, 1.0)
    low = -span if minimum is None else minimum
    high = span if maximum is None else maximum
    # Rounded inwards, because the station refuses a value beyond its range.
    low, high = math.ceil(low * 1e3 - 1e-6) / 1e3, math.floor(high * 1e3 + 1e-6) / 1e3
    if high <= low:
        high = low + 1e-3
    return SliderScale(low, high, 1e-3)


def gain_scale(
    value: float, minimum: float | None, maximum: float | None
) -> SliderScale:
    """Return the scale for a gain whose allowed range may be too wide for a slider.

    The slider ends at a round number above twice the present value; the number
    entry beside it takes the whole allowed range.

    Args:
        value: Present value.
        minimum: Smallest value allowed; None where unlimited.
        maximum: Largest value allowed; None where unlimited.
    """
    reach = _round_up(2.0 * abs(value) or GAIN_REACH)
    low = (-reach if value < 0.0 else 0.0) if minimum is None else max(minimum, -reach)
    high = reach if maximum is None else min(maximum, reach)
    if high <= low:
        high = low + 1.0
    return SliderScale(low, high, _round_up((high - low) / 1000.0))


def _round_up(value: float) -> float:
    """Return the next of 1, 2, 5, 10, 20, … that is at least `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    for factor in (1.0, 2.0, 5.0):
        if value <= factor * power * (1.0 + 1e-9):
            return float(f"{factor * power:.12g}")
    return float(f"{10.0 * power:.12g}")
