"""The shape of the robot on the wire."""

from station.wire import Hardware


def test_the_example_is_valid():
    (example,) = Hardware.model_config["json_schema_extra"]["examples"]

    hardware = Hardware.model_validate(example)

    assert hardware.model_dump(mode="json") == example
