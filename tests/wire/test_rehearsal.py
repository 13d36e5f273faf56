"""Requests of rehearsals and plans."""

import pytest

from station.core.description.urdf import Pose
from station.wire.rehearsal import Place


def test_the_angles_of_a_place_are_its_quaternion():
    angles = (0.3, -0.5, 2.0)
    w, x, y, z = Pose.from_rpy((0.0, 0.0, 0.0), angles).quaternion
    told = Place(position=[0.3, 0.0, 0.5], rpy=list(angles)).quaternion()
    assert told == pytest.approx([x, y, z, w])


def test_a_place_without_angles_keeps_its_quaternion_or_none():
    there = [0.3, 0.0, 0.5]
    assert Place(position=there).quaternion() is None
    turned = Place(position=there, orientation=[1.0, 0.0, 0.0, 0.0])
    assert turned.quaternion() == [1.0, 0.0, 0.0, 0.0]
