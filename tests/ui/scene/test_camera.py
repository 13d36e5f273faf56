"""From where a browser looks."""

import numpy as np
import pytest

from station.ui.scene.camera import PRESETS, corners_of, look
from station.ui.scene.layers.layer import PlacedRobot
from station.ui.scene.robot_model import load_robot


@pytest.mark.parametrize("preset", PRESETS)
def test_every_place_sees_the_robot(client, panda, preset):
    positions = {"panda_joint4": -2.0, "panda_joint6": 2.0}
    look(client, preset, [panda], positions)
    target = np.array(client.camera.look_at)
    low, high = panda.model.bounds(positions)
    assert (low - 0.01 <= target).all()
    assert (target <= high + 0.01).all()
    assert 0.5 < np.linalg.norm(client.camera.position - target) < 5.0


def test_two_arms_far_apart_are_both_seen_and_fill_the_picture(client, panda):
    base = (0.0, 2.0, 0.0, 0.0, 0.0, 0.0)
    other = load_robot("example-robot-data:panda", arm_id="panda_2", base=base)
    look(client, "fit", [panda, PlacedRobot(other, "/robot_2")], {})
    camera = client.camera
    corners = corners_of([panda.model.bounds({}), other.bounds({})])
    seen = _in_picture(camera, corners)
    assert 0.8 < np.abs(seen).max() < 1.0


def test_robots_are_fitted_into_the_part_of_the_picture_that_can_be_seen(client, panda):
    base = (0.0, 2.0, 0.0, 0.0, 0.0, 0.0)
    other = load_robot("example-robot-data:panda", arm_id="panda_2", base=base)
    robots = [panda, PlacedRobot(other, "/robot_2")]
    look(client, "fit", robots, {}, covered=0.25)
    corners = corners_of([panda.model.bounds({}), other.bounds({})])
    across = _in_picture(client.camera, corners)[0]
    # The left quarter of a picture ends half way from its left edge to its middle.
    assert -0.5 < across.min() < -0.2
    assert 0.7 < across.max() < 1.0


def _in_picture(camera, points):
    """Return where points are in the picture; its edges are at -1 and 1."""
    forward = camera.look_at - camera.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    away = points - camera.position
    depth = away @ forward
    tall = np.tan(camera.fov / 2.0) * depth
    up = np.cross(right, forward)
    return np.stack([away @ right / (tall * camera.aspect), away @ up / tall])


def test_the_front_is_along_x_at_the_height_of_the_robot(client, panda):
    look(client, "front", [panda], {})
    x, y, z = client.camera.position - client.camera.look_at
    assert x > 1.0
    assert (y, z) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_without_a_robot_the_camera_stays(client):
    before = tuple(client.camera.position)
    look(client, "top", [], {})
    assert tuple(client.camera.position) == before
