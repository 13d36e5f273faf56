"""Mass properties of bodies that are fixed to each other."""

from math import pi

import pytest

from station.core.description.urdf import Inertial, Pose
from station.hw.mujoco.inertia import combine, is_rigid_body

ROD = Inertial(2.0, Pose(), (0.1, 0.2, 0.25, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("moments", "expected"),
    [
        ((1.0, 1.0, 1.0), True),
        ((0.0, 0.0, 0.0), False),
        ((1.0, 1.0, 3.0), False),
        ((-1.0, 1.0, 1.0), False),
    ],
)
def test_inertia_of_a_rigid_body_is_recognised(
    moments: tuple[float, float, float], *, expected: bool
) -> None:
    assert is_rigid_body(Inertial(1.0, Pose(), (*moments, 0, 0, 0))) is expected


def test_turned_body_has_turned_moments() -> None:
    turned = combine([(Pose.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, pi / 2)), ROD)])
    assert turned.inertia == pytest.approx((0.2, 0.1, 0.25, 0.0, 0.0, 0.0))


def test_two_equal_bodies_have_their_centre_between_them() -> None:
    pair = combine([(Pose((1.0, 0.0, 0.0)), ROD), (Pose((-1.0, 0.0, 0.0)), ROD)])
    assert pair.mass == 4.0
    assert pair.origin.xyz == pytest.approx((0.0, 0.0, 0.0))
    # Twice the body's own moment and twice 2 kg at 1 m about y and z.
    assert pair.inertia == pytest.approx((0.2, 4.4, 4.5, 0.0, 0.0, 0.0))
