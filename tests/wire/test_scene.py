"""Wire models of the things around a robot."""

from station.wire import SceneObject


def test_the_example_is_valid():
    (example,) = SceneObject.model_config["json_schema_extra"]["examples"]

    assert SceneObject.model_validate(example).name == "cube"
