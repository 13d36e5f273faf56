"""What touches what in a MuJoCo world."""

import mujoco
import pytest

from station.core.geometry.scene import read_object
from station.hw.mujoco.model_builder import add_object, compile_world, new_world
from station.hw.mujoco.shared_world import MOST_CONTACTS, touching


def _settled(*things, steps=1500):
    spec = new_world(0.001)
    for thing in things:
        add_object(spec, read_object(thing, "x"))
    model = compile_world(spec)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, steps)
    return touching(model, data)


def test_a_ball_presses_on_the_floor_with_its_weight():
    ball = {"name": "ball", "type": "sphere", "size": [0.05], "mass": 0.2}
    (contact,) = _settled({**ball, "position": [0.3, 0.1, 0.05]})
    assert contact.bodies == ("world", "ball")
    assert contact.position == pytest.approx((0.3, 0.1, 0.0), abs=1e-3)
    # 0.2 kg x 9.81 m/s^2, upwards on the ball.
    assert contact.force == pytest.approx((0.0, 0.0, 1.962), abs=0.01)


def test_nothing_touches_in_the_air():
    ball = {"name": "ball", "type": "sphere", "size": [0.05], "mass": 0.2}
    assert _settled({**ball, "position": [0.0, 0.0, 1.0]}, steps=1) == []


def test_of_very_many_contacts_some_are_reported():
    box = {"type": "box", "size": [0.02, 0.02, 0.02], "mass": 0.01}
    boxes = [
        {**box, "name": f"b{i}", "position": [0.05 * (i % 5), 0.05 * (i // 5), 0.01]}
        for i in range(20)
    ]
    assert len(_settled(*boxes, steps=200)) == MOST_CONTACTS
