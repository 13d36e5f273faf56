"""Functions of one number from the C library, the same ones in both modes."""

import cython

if cython.compiled:
    from cython.cimports.libc.math import (
        atan2 as _atan2,
        cos as _cos,
        exp as _exp,
        sin as _sin,
        sqrt as _sqrt,
    )
else:
    from math import (
        atan2 as _atan2,
        cos as _cos,
        exp as _exp,
        sin as _sin,
        sqrt as _sqrt,
    )


def square_root(value: float) -> float:
    """Return the square root of a number >= 0."""
    root: float = _sqrt(value)
    return root


def sine(angle: float) -> float:
    """Return the sine of a finite angle [rad]."""
    result: float = _sin(angle)
    return result


def cosine(angle: float) -> float:
    """Return the cosine of a finite angle [rad]."""
    result: float = _cos(angle)
    return result


def arctangent(y: float, x: float) -> float:
    """Return the angle of the point (x, y) from the x axis [rad], -pi to pi."""
    angle: float = _atan2(y, x)
    return angle


def exponential(value: float) -> float:
    """Return e to the power of a number that is not above 700."""
    result: float = _exp(value)
    return result


if not cython.compiled:
    # The same functions, without a call in Python around each of them.
    square_root, sine, cosine = _sqrt, _sin, _cos
    arctangent, exponential = _atan2, _exp
