"""A robot in the scene, and the end of a layer."""

import pytest

from station.ui.scene.layers.layer import PlacedRobot
from station.ui.scene.robot_model import load_robot
from station.ui.scene.scene_views import CollisionLayer


def test_a_franka_has_base_and_flange(panda):
    assert (panda.base, panda.flange) == ("panda_link0", "panda_link8")
    assert panda.node_of("panda_link1") == "/robot/panda_link0/panda_link1"


def test_the_flange_of_another_robot_is_its_last_link():
    robot = PlacedRobot(load_robot("example-robot-data:ur5"), "/robot")
    assert robot.base == "base_link"
    assert robot.flange in {"tool0", "ee_link"}


def test_the_flange_is_where_the_datasheet_says(panda):
    # At zero the arm is straight: 0.088 m in front, 0.333 + 0.316 + 0.384 m high, and
    # the flange hangs 0.107 m below (Franka Emika, Denavit-Hartenberg parameters).
    flange = panda.poses({})[panda.flange].xyz
    assert flange == pytest.approx((0.088, 0.0, 0.926), abs=1e-9)


def test_a_layer_that_is_removed_leaves_nothing_in_the_scene(draw, node):
    layer = draw(CollisionLayer)
    paths = list(layer.nodes)
    assert all(node(path) is not None for path in paths)
    layer.remove()
    assert all(node(path) is None for path in paths)
    assert layer.nodes == {}
