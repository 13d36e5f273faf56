"""Joints near their limits."""

import pytest

from station.ui.scene.layers.layer import SceneFacts
from station.ui.scene.layers.robot_layers import LimitsLayer, nearness

LIMITS = {"panda_joint4": (-3.0, 0.0), "panda_finger_joint1": (0.0, 0.04)}
LINK = "/robot/panda_link0/panda_link1/panda_link2/panda_link3/panda_link4"


def _facts(q):
    return SceneFacts(positions={"panda_joint4": q}, limits=LIMITS)


def test_a_link_is_tinted_while_its_joint_is_near_a_limit(draw, node):
    layer = draw(LimitsLayer)
    layer.show(_facts(-1.5))
    assert node(f"{LINK}/tint") is None
    layer.show(_facts(-0.1))
    assert node(f"{LINK}/tint") is not None
    assert node(f"{LINK}/near_limit").text == "panda_joint4: 6° to its upper limit"
    layer.show(_facts(-0.05))
    assert node(f"{LINK}/near_limit").text == "panda_joint4: 3° to its upper limit"
    layer.show(_facts(-1.5))
    assert node(f"{LINK}/tint") is None


@pytest.mark.parametrize(
    ("q", "said"),
    [(-2.9, "6° to its lower limit"), (-2.8, ""), (0.1, "-6° to its upper limit")],
)
def test_what_is_said_of_a_joint(panda, q, said):
    joint = panda.model.urdf.joints["panda_joint4"]
    assert said in nearness(joint, _facts(q))
    assert bool(nearness(joint, _facts(q))) == bool(said)


def test_a_closed_hand_is_not_near_a_limit(panda):
    joint = panda.model.urdf.joints["panda_finger_joint1"]
    facts = SceneFacts(positions={"panda_finger_joint1": 0.0}, limits=LIMITS)
    assert not nearness(joint, facts)
