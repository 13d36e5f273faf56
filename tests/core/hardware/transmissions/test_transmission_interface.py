"""An interface carries the values of all its handles in one call.

Many transmissions in one call give what each of them gives by itself.
"""

import gzip
import json
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from station.core.errors import ResourceNotFoundError
from station.core.hardware import transmissions
from station.core.hardware.transmissions import (
    ActuatorData,
    ActuatorToJointEffortInterface,
    ActuatorToJointStateInterface,
    DifferentialTransmission,
    Direction,
    JointData,
    Propagation,
    SimpleTransmission,
    TransmissionHandle,
)
from station.memory.doubles import Block, doubles, put
from tests.both_modes import bits, numbers

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


_ALL = ("position", "velocity", "effort", "absolute_position", "torque_sensor")
_SIZE = 4
reductions = st.floats(-100.0, 100.0).filter(lambda value: abs(value) > 1e-3)


class Doubled(SimpleTransmission):
    """A simple transmission whose efforts are doubled."""

    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        return [2.0 * value for value in super().actuator_to_joint_effort(effort)]


def _places(kind, block, places):
    data = kind()
    for quantity in _ALL:
        data.set_quantity(quantity, [(block[quantity], place) for place in places])
    return data


def _handles(transmissions, actuators, joints, direction):
    """Connect the transmissions to places in the blocks, the joints' in reverse."""
    handles, first = [], 0
    quantities = _ALL if direction is Direction.ACTUATOR_TO_JOINT else _ALL[:3]
    for number, one in enumerate(transmissions):
        places = range(first, first + one.num_joints)
        handles.append(
            TransmissionHandle(
                f"t{number}",
                one,
                _places(ActuatorData, actuators, places),
                _places(JointData, joints, [_SIZE - 1 - place for place in places]),
                direction=direction,
                quantities=quantities,
            )
        )
        first += one.num_joints
    return handles


@given(
    st.lists(reductions, min_size=_SIZE, max_size=_SIZE),
    st.lists(numbers, min_size=5 * _SIZE, max_size=5 * _SIZE),
    st.sampled_from(Direction),
    st.booleans(),
)
def test_values_are_carried_as_by_each_transmission(given, values, direction, mixed):
    simple = [SimpleTransmission(given[0], 0.5), SimpleTransmission(given[1], -0.0)]
    others = [SimpleTransmission(given[2]), Doubled(given[3], 1.0)]
    if mixed:
        others = [DifferentialTransmission(given[2:], [1.0, 2.0])]
    results = []
    for carries_together in (False, True):
        sizes = dict.fromkeys(_ALL, _SIZE)
        actuators, joints = Block(sizes), Block(sizes)
        to_joints = direction is Direction.ACTUATOR_TO_JOINT
        put((actuators if to_joints else joints).memory, values)
        handles = _handles([*simple, *others], actuators, joints, direction)
        if carries_together:
            Propagation(handles).carry()
        else:
            for handle in handles:
                handle.propagate()
        results.append((joints if to_joints else actuators).memory)
    assert bits(results[0]) == bits(results[1])


def test_values_in_lists_are_carried_one_by_one():
    handle = TransmissionHandle(
        "t",
        SimpleTransmission(2.0),
        ActuatorData(velocity=[([3.0], 0)]),
        JointData(velocity=[(target := [0.0], 0)]),
        direction=Direction.ACTUATOR_TO_JOINT,
        quantities=("velocity",),
    )
    Propagation([handle]).carry()
    assert target == [1.5]


def test_a_velocity_of_minus_zero_keeps_its_sign():
    source, target = doubles([-0.0]), doubles([1.0])
    handle = TransmissionHandle(
        "t",
        SimpleTransmission(2.0),
        ActuatorData(velocity=[(source, 0)]),
        JointData(velocity=[(target, 0)]),
        direction=Direction.ACTUATOR_TO_JOINT,
        quantities=("velocity",),
    )
    Propagation([handle]).carry()
    assert str(target[0]) == "-0.0"
