"""Forces on the arms."""

import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.ui.link.station_view import ArmFacts
from station.ui.scene.layers.forces_layer import ForcesLayer
from station.ui.scene.layers.layer import SceneFacts
from station.wire import Contact

TOOL = Pose((0.0, 0.0, 0.1))


def _facts(force):
    return SceneFacts(arms={"panda": ArmFacts(TOOL, Pose(), force)})


def test_a_force_is_an_arrow_that_begins_at_the_stiffness_frame(draw, node, panda):
    layer = draw(ForcesLayer)
    layer.show(_facts((0.0, 0.0, 20.0)))
    ((tail, tip),) = node("/force_panda").points
    # The flange points down at zero, so EE is 0.1 m below it.
    flange = np.array(panda.poses({})["panda_link8"].xyz)
    assert tail == pytest.approx(flange - (0.0, 0.0, 0.1), abs=1e-6)
    assert tip - tail == pytest.approx((0.0, 0.0, 0.3), abs=1e-6)
    assert node("/force_panda_label").text == "20 N on the arm"


@pytest.mark.parametrize("force", [None, (0.5, 0.5, 0.5)])
def test_noise_and_what_is_not_known_are_not_drawn(draw, node, force):
    layer = draw(ForcesLayer)
    layer.show(_facts((0.0, 0.0, 20.0)))
    layer.show(_facts(force))
    assert node("/force_panda") is None
    assert node("/force_panda_label") is None


def test_a_large_force_is_no_longer_than_the_arm(draw, node):
    layer = draw(ForcesLayer)
    layer.show(_facts((0.0, 500.0, 0.0)))
    ((tail, tip),) = node("/force_panda").points
    assert np.linalg.norm(tip - tail) == pytest.approx(0.6)


def _touching(force, bodies=("world", "cube")):
    contact = Contact(bodies=list(bodies), position=[0.5, 0.0, 0.0], force=force)
    return SceneFacts(contacts=[contact])


def test_a_contact_is_a_point_with_the_force_on_the_second_body(draw, node):
    layer = draw(ForcesLayer)
    layer.show(_touching([0.0, 0.0, 10.0]))
    assert node("/contacts/points").points == pytest.approx(np.array([[0.5, 0.0, 0.0]]))
    ((tail, tip),) = node("/contacts/forces").points
    assert tail == pytest.approx((0.5, 0.0, 0.0))
    assert tip == pytest.approx((0.5, 0.0, 0.15))
    layer.show(SceneFacts())
    assert node("/contacts/points") is None
    assert node("/contacts/forces") is None


def test_a_light_contact_is_a_point_alone(draw, node):
    layer = draw(ForcesLayer)
    layer.show(_touching([0.0, 0.0, 0.5]))
    assert node("/contacts/points") is not None
    assert node("/contacts/forces") is None


@pytest.mark.parametrize(
    ("bodies", "force", "text"),
    [
        (("panda_hand", "table"), -20.0, "panda_hand touches table, 20 N"),
        (("world", "panda_link7"), 20.0, "panda_link7 touches the floor, 20 N"),
    ],
)
def test_a_contact_of_the_arm_shows_the_force_on_the_arm_and_names_both(
    draw, node, bodies, force, text
):
    layer = draw(ForcesLayer)
    layer.show(_touching([0.0, 0.0, force], bodies))
    ((tail, tip),) = node("/contacts/forces").points
    assert tip - tail == pytest.approx((0.0, 0.0, 0.3))
    label = node("/contacts/label")
    assert (label.text, label.visible) == (text, True)
    layer.show(SceneFacts())
    assert not label.visible


@pytest.mark.parametrize("bodies", [("world", "cube"), ("panda_hand", "cube")])
def test_contacts_of_things_and_light_ones_have_no_words(draw, node, bodies):
    layer = draw(ForcesLayer)
    strong = 20.0 if "world" in bodies else 1.0
    layer.show(_touching([0.0, 0.0, strong], bodies))
    assert not node("/contacts/label").visible


def test_of_several_contacts_the_pair_that_presses_most_is_named(draw, node):
    layer = draw(ForcesLayer)
    pressing = [("panda_leftfinger", 8.0), ("panda_leftfinger", 9.0), ("panda_hand", 9)]
    contacts = [
        Contact(bodies=["cube", link], position=[0.5, 0.0, 0.1], force=[0.0, force, 0])
        for link, force in pressing
    ]
    layer.show(SceneFacts(contacts=contacts))
    assert node("/contacts/label").text == "panda_leftfinger touches cube, 17 N"
