"""The frames of the arms."""

import pytest

from station.core.description.urdf import Pose
from station.ui.link.station_view import ArmFacts
from station.ui.scene.layers.layer import SceneFacts
from station.ui.scene.layers.robot_layers import FramesLayer

TOOL = Pose((0.0, 0.0, 0.1034))


def _facts(stiffness=None):
    return SceneFacts(arms={"panda": ArmFacts(TOOL, stiffness or Pose(), None)})


def test_base_and_flange_are_always_there(draw, node, panda):
    draw(FramesLayer)
    assert node(f"{panda.node_of('panda_link0')}/frame_O/name").text == "O"
    assert node(f"{panda.node_of('panda_link8')}/frame_F/name").text == "F"


def test_the_tool_is_where_the_arm_says(draw, node, panda):
    layer = draw(FramesLayer)
    flange = panda.node_of(panda.flange)
    layer.show(_facts())
    assert tuple(node(f"{flange}/frame_EE").position) == TOOL.xyz
    assert node(f"{flange}/frame_EE/name").text == "EE, K"
    assert node(f"{flange}/frame_K") is None


def test_a_stiffness_frame_of_its_own_has_axes_of_its_own(draw, node, panda):
    layer = draw(FramesLayer)
    flange = panda.node_of(panda.flange)
    layer.show(_facts())
    layer.show(_facts(Pose((0.0, 0.05, 0.0))))
    assert node(f"{flange}/frame_EE/name").text == "EE"
    assert tuple(node(f"{flange}/frame_K").position) == pytest.approx((
        0.0,
        0.05,
        0.1034,
    ))
    layer.show(_facts())
    assert node(f"{flange}/frame_K") is None
