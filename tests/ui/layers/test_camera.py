"""From where a browser looks."""

import numpy as np
import pytest

from station.ui.layers.camera import PRESETS, look


@pytest.mark.parametrize("preset", PRESETS)
def test_every_place_sees_the_robot(client, panda, preset):
    positions = {"panda_joint4": -2.0, "panda_joint6": 2.0}
    look(client, preset, [panda], positions)
    target = np.array(client.camera.look_at)
    low, high = panda.model.bounds(positions)
    assert (low - 0.01 <= target).all()
    assert (target <= high + 0.01).all()
    assert 0.5 < np.linalg.norm(client.camera.position - target) < 5.0


def test_the_front_is_along_x_at_the_height_of_the_robot(client, panda):
    look(client, "front", [panda], {})
    x, y, z = client.camera.position - client.camera.look_at
    assert x > 1.0
    assert (y, z) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_without_a_robot_the_camera_stays(client):
    before = tuple(client.camera.position)
    look(client, "top", [], {})
    assert tuple(client.camera.position) == before
