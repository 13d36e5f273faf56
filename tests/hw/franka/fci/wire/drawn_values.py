"""Hypothesis' values for the fields of a structure."""

from hypothesis import strategies as st

NUMBERS = st.floats(allow_nan=False)


@st.composite
def values_of(draw, structure):
    """Draw a value for every field, of the field's own kind."""
    zero = structure.unpack(bytes(structure.size))
    drawn = {}
    for name, value in zero.items():
        kinds = {bool: st.booleans(), float: NUMBERS, int: st.integers(0, 255)}
        first = value[0] if isinstance(value, tuple) else value
        one = kinds[type(first)]
        count = structure.counts[name]
        tuples = st.lists(one, min_size=count, max_size=count).map(tuple)
        drawn[name] = draw(tuples if isinstance(value, tuple) else one)
    return drawn
