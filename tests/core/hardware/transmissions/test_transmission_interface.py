"""An interface carries the values of all its handles in one call."""

import gzip
import json
from pathlib import Path

import pytest

from station.core.errors import ResourceNotFoundError
from station.core.hardware import transmissions
from station.core.hardware.transmissions import (
    ActuatorData,
    ActuatorToJointEffortInterface,
    ActuatorToJointStateInterface,
    JointData,
    SimpleTransmission,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmissions.json.gz"


@pytest.fixture(scope="module")
def cases():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["handle_cases"]


def test_unknown_transmission_is_refused_with_the_recorded_message(cases):
    with pytest.raises(ResourceNotFoundError) as caught:
        ActuatorToJointStateInterface().get_handle("zzz")
    assert caught.value.message == cases[-1]["exception"]["what"]


def test_interface_propagates_every_handle_and_slots_follow_their_index():
    effort, torque = [1.0, 2.0], [0.0, 0.0]
    interface = ActuatorToJointEffortInterface()
    for index, name in enumerate("ab"):
        actuator = ActuatorData(effort=[(effort, index)])
        joint = JointData(effort=[(torque, 1 - index)])
        maps = SimpleTransmission(10.0)
        interface.connect(name, maps, actuator, joint)
    interface.propagate()
    assert torque == [20.0, 10.0]


@pytest.mark.parametrize("side", ["ActuatorToJoint", "JointToActuator"])
@pytest.mark.parametrize("quantity", ["State", "Position", "Velocity", "Effort"])
def test_interfaces_have_the_names_of_the_original(side, quantity):
    name = f"{side}{quantity}Interface"
    interface_type = getattr(transmissions, name)
    assert interface_type.type_name == f"transmission_interface::{name}"
    carried = ("position", "velocity", "effort")
    if quantity != "State":
        assert interface_type.quantities == (quantity.lower(),)
    else:
        assert interface_type.quantities[:3] == carried
