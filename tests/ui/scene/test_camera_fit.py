"""How far a camera stands back."""

import math

import numpy as np
import pytest

from station.ui.scene.camera import corners_of, fitting_distance

CUBE = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
RIGHT_ANGLE = math.radians(90.0)


def test_a_box_has_eight_corners():
    corners = corners_of([CUBE, CUBE + 3.0])
    assert len({tuple(corner) for corner in corners}) == 16
    assert corners.min(axis=0) == pytest.approx((-1.0, -1.0, -1.0))
    assert corners.max(axis=0) == pytest.approx((4.0, 4.0, 4.0))


@pytest.mark.parametrize(("aspect", "distance"), [(1.0, 2.0), (2.0, 2.0), (0.5, 3.0)])
def test_the_near_face_of_a_cube_just_fits(aspect, distance):
    """At 90 degrees the face, 1 m before the middle and 1 m high, is seen from 1 m."""
    found = fitting_distance(
        corners_of([CUBE]),
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        field_of_view=RIGHT_ANGLE,
        aspect=aspect,
    )
    assert found == pytest.approx(distance)
