"""The trail of the hand."""

import pytest

from station.ui.scene.layers.layer import SceneFacts
from station.ui.scene.layers.robot_layers import TrailLayer, Trails


def test_a_trail_grows_with_the_way_of_the_flange(panda):
    trails = Trails([panda])
    trails.note({"panda_joint1": 0.0})
    assert len(trails.note({"panda_joint1": 0.001})[0]) == 1  # 0.1 mm further
    (path,) = trails.note({"panda_joint1": 0.5})
    assert len(path) == 2
    assert path[-1] == pytest.approx(
        panda.poses({"panda_joint1": 0.5})["panda_link8"].xyz
    )


def test_a_trail_keeps_its_last_metres(panda):
    trails = Trails([panda])
    for i in range(700):
        (path,) = trails.note({"panda_joint1": 0.1 * (i % 60)})
    assert len(path) == 600


def test_a_trail_is_drawn_when_it_has_become_longer(draw, node):
    layer = draw(TrailLayer)
    layer.show(SceneFacts(trails=[[(0.0, 0.0, 0.0)]]))
    assert node("/trail_0") is None
    path = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.2, 0.0)]
    layer.show(SceneFacts(trails=[path]))
    assert node("/trail_0").points.shape == (2, 2, 3)
    before = node("/trail_0")
    layer.show(SceneFacts(trails=[path]))
    assert node("/trail_0") is before
