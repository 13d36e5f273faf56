"""The commanded pose."""

from station.ui.scene.layers.layer import SceneFacts
from station.ui.scene.layers.robot_layers import CommandedLayer


def _facts(apart):
    here = {"panda_joint1": 0.2, "panda_joint2": 0.1}
    return SceneFacts(positions=here, commanded={"panda_joint1": 0.2 + apart})


def test_the_figure_is_there_while_the_arm_is_elsewhere(draw, node):
    layer = draw(CommandedLayer)
    layer.show(_facts(0.0))
    assert node("/commanded_0") is None
    layer.show(_facts(0.3))
    assert node("/commanded_0").visible
    label = node("/commanded_0_label")
    assert (label.text, label.visible) == ("commanded pose", True)
    assert label.position[2] > 0.9  # Over the arm, which is straight.
    layer.show(_facts(0.0))
    assert not node("/commanded_0").visible
    assert not label.visible


def test_the_figure_does_not_flicker_at_its_threshold(draw, node):
    layer = draw(CommandedLayer)
    layer.show(_facts(0.02))
    assert node("/commanded_0") is None
    layer.show(_facts(0.04))
    layer.show(_facts(0.02))
    assert node("/commanded_0").visible


def test_commands_of_another_robot_move_nothing(draw, node):
    layer = draw(CommandedLayer)
    layer.show(SceneFacts(positions={"other": 0.0}, commanded={"other": 1.0}))
    assert node("/commanded_0") is None
