"""Numbers as JSON can say them."""

import math
from collections.abc import Iterable


def measured(value: float) -> float | None:
    """Return `value`, or None when it is not finite: JSON has no word for that."""
    return value if math.isfinite(value) else None


def measured_list(values: Iterable[float]) -> list[float | None]:
    """Return `values` with None for each that is not finite."""
    return [measured(value) for value in values]
