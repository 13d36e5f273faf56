"""What the URDF mounts at the flange."""

from math import cos, pi

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.simulated.end_effector import end_effector_of, nominal_frame_of
from station.hw.urdf_loader import load_urdf

HALF = cos(pi / 4)


@pytest.fixture(scope="module")
def urdf():
    return load_urdf(load_robot_files("example-robot-data:panda"))


def test_hand_and_fingers_combine_to_one_body(urdf):
    body = end_effector_of(urdf, "panda_", 0.08)

    assert body.mass == pytest.approx(0.73 + 2 * 0.015)
    # The hand's centre, turned by -45 degrees; the fingers are on both sides.
    x = -0.01 * HALF * 0.73 / body.mass
    assert body.center_of_mass[:2] == pytest.approx((x, -x), abs=1e-9)
    z = (0.73 * 0.03 + 0.03 * 0.0584) / body.mass
    assert body.center_of_mass[2] == pytest.approx(z)


def test_nominal_frame_is_the_tip_of_the_hand(urdf):
    frame = nominal_frame_of(urdf, "panda_")

    assert frame[:3] == pytest.approx((HALF, -HALF, 0.0))
    assert frame[12:] == pytest.approx((0.0, 0.0, 0.1034, 1.0))
