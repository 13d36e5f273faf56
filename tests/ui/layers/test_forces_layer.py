"""Forces on the arms."""

import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.ui.layers.forces_layer import ForcesLayer
from station.ui.layers.scene_facts import ArmFacts, SceneFacts
from station.wire import Contact

TOOL = Pose((0.0, 0.0, 0.1))


def _facts(force):
    return SceneFacts(arms={"panda": ArmFacts(TOOL, Pose(), force)})


def test_a_force_is_an_arrow_that_ends_at_the_stiffness_frame(draw, node, panda):
    layer = draw(ForcesLayer)
    layer.show(_facts((0.0, 0.0, 20.0)))
    ((tail, tip),) = node("/force_panda").points
    # The flange points down at zero, so EE is 0.1 m below it.
    flange = np.array(panda.poses({})["panda_link8"].xyz)
    assert tip == pytest.approx(flange - (0.0, 0.0, 0.1), abs=1e-6)
    assert tip - tail == pytest.approx((0.0, 0.0, 0.2), abs=1e-6)
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


def _touching(force):
    contact = Contact(bodies=["world", "cube"], position=[0.5, 0.0, 0.0], force=force)
    return SceneFacts(contacts=[contact])


def test_a_contact_is_a_point_with_the_force_on_the_second_body(draw, node):
    layer = draw(ForcesLayer)
    layer.show(_touching([0.0, 0.0, 10.0]))
    assert node("/contacts/points").points == pytest.approx(np.array([[0.5, 0.0, 0.0]]))
    ((tail, tip),) = node("/contacts/forces").points
    assert tail == pytest.approx((0.5, 0.0, 0.0))
    assert tip == pytest.approx((0.5, 0.0, 0.1))
    layer.show(SceneFacts())
    assert node("/contacts/points") is None
    assert node("/contacts/forces") is None


def test_a_light_contact_is_a_point_alone(draw, node):
    layer = draw(ForcesLayer)
    layer.show(_touching([0.0, 0.0, 0.5]))
    assert node("/contacts/points") is not None
    assert node("/contacts/forces") is None
