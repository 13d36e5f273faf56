"""The shape of the robot on the wire."""

import json

from station.wire import Hardware
from station.wire.base import read_json


def test_the_example_is_valid():
    (example,) = Hardware.model_config["json_schema_extra"]["examples"]

    hardware = read_json(Hardware, json.dumps(example))

    assert hardware.model_dump(mode="json") == example
