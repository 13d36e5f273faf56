"""A twist is two vectors, each within its limit."""

import pytest

from station.controllers.cartesian_motion.cartesian_limits import (
    ROTATION,
    TRANSLATION,
    CartesianLimits,
)
from station.controllers.cartesian_motion.jog_and_streaming_controllers import (
    TwistSetPointPort,
)
from station.core.errors import InvalidCommandError


@pytest.fixture
def port():
    limits = CartesianLimits(TRANSLATION, ROTATION)
    return TwistSetPointPort(limits, timeout=0.2, longest=1.0)


def test_full_speed_is_taken_in_any_direction(port):
    port.check([0.3, 0.0, 0.0, 0.0, -1.0, 0.0])
    port.check([0.18, -0.24, 0.0, 0.6, 0.0, 0.8])


@pytest.mark.parametrize(
    ("twist", "bound"),
    [([0.25, 0.25, 0, 0, 0, 0], "0.3 m/s"), ([0, 0, 0, 0.8, 0.8, 0], "1.0 rad/s")],
)
def test_a_vector_that_is_too_long_is_refused(port, twist, bound):
    with pytest.raises(InvalidCommandError, match=f"allowed is at most {bound}"):
        port.check([float(value) for value in twist])
