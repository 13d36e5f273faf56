"""The shape of the robot on the wire."""

import json

from station.reports import examples_of
from station.wire import Hardware
from station.wire.base import reader_of


def test_the_example_is_valid():
    (example,) = examples_of(Hardware.__doc__)

    hardware = reader_of(Hardware).validate_json(json.dumps(example))

    assert hardware.model_dump(mode="json") == example
