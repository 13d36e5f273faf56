"""Wire models of the things around a robot."""

from station.reports import examples_of
from station.wire import SceneObject


def test_the_example_is_valid():
    (example,) = examples_of(SceneObject.__doc__)

    assert SceneObject.model_validate(example).name == "cube"
