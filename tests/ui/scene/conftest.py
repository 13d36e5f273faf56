"""A browser, and a Panda in its scene, for tests of the scene."""

import pytest

from station.ui.scene.layers.layer import PlacedRobot
from station.ui.scene.robot_model import load_robot


@pytest.fixture(scope="package")
def panda():
    return PlacedRobot(load_robot("example-robot-data:panda"), "/robot")


@pytest.fixture
def draw(client, panda):
    """Make a layer, and take it out of the scene after the test."""
    made = []

    def make(kind):
        made.append(kind(client, [panda]))
        return made[-1]

    yield make
    for layer in made:
        layer.remove()


@pytest.fixture
def node(client):
    """Find a scene node of the browser by its name."""
    return client.scene.get_handle_by_name
