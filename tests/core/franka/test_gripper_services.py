"""Which widths a grasp expects."""

import pytest

from station.core.franka import GraspRequest


@pytest.mark.parametrize(
    ("width", "accepted"),
    [(0.03, True), (0.0251, True), (0.0249, False), (0.0349, True), (0.0351, False)],
)
def test_the_tolerance_is_half_a_centimetre_unless_told_otherwise(width, accepted):
    assert GraspRequest(0.03, 20.0).accepts(width) is accepted


def test_both_sides_have_their_own_tolerance():
    request = GraspRequest(0.03, 20.0, epsilon_inner=0.001, epsilon_outer=0.02)

    assert not request.accepts(0.028)
    assert request.accepts(0.045)
