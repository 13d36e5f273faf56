"""Random joints with limits, driven for some cycles, for tests of both modes."""

from math import inf, nan

from hypothesis import strategies as st

from station.core.hardware.limits.limited_joints import LIMITS, MEMORY
from station.memory.doubles import doubles

numbers = st.floats() | st.floats(-3.0, 3.0) | st.sampled_from([0.0, -0.0, 1e-310])
sizes = st.floats(0.0, 5.0) | st.sampled_from([0.0, 1e-310, 1e308, inf])
periods = st.sampled_from([0.001, 0.02, 1e-310, 0.0, -0.001])
QUANTITIES = ("position", "velocity", "command")


@st.composite
def joints(draw, *, unlimited=nan, most=4):
    """Return the views of a group and the states and commands of some cycles."""
    count = draw(st.integers(1, most))
    column = st.lists(numbers, min_size=count, max_size=count)
    magnitudes = sizes | st.just(unlimited)
    views = {}
    for name in LIMITS:
        values = [draw(magnitudes) for _ in range(count)]
        if name.endswith("_min") or name.startswith("min_"):
            values = [-value for value in values]
        views[name] = values
    for name in MEMORY:
        views[name] = [nan] * count
    for name in (*QUANTITIES, "asked", "reason"):
        views[name] = [0.0] * count
    cycles = draw(
        st.lists(st.tuples(periods, column, column, column), min_size=1, max_size=5)
    )
    return views, cycles


def play(kind, case):
    """Return all that a group says and remembers in some cycles, with every sign."""
    start, cycles = case
    views = {name: doubles(values) for name, values in start.items()}
    group = kind(views)
    seen = []
    for period, *values in cycles:
        for name, column in zip(QUANTITIES, values, strict=True):
            views[name][:] = doubles(column)
        mask = group.enforce(period, 0, len(values[0]))
        seen.append((mask, {name: repr(view.tolist()) for name, view in views.items()}))
    return seen
