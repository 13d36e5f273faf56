"""Handles carry values between places, and refuse places that do not fit."""

import gzip
import json
import re
from pathlib import Path

import pytest

from station.core.hardware import transmissions
from station.core.hardware.transmissions import (
    ActuatorData,
    ActuatorToJointStateInterface,
    DifferentialTransmission,
    JointData,
    JointToActuatorStateInterface,
    SimpleTransmission,
    TransmissionInterfaceError,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmissions.json.gz"
QUANTITIES = ("position", "velocity", "effort")


@pytest.fixture(scope="module")
def cases():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["handle_cases"]


def fill(data, size, *, slot=True):
    for quantity in QUANTITIES if size else ():
        places = [([0.0], 0) if slot else None for _ in range(size)]
        data.set_quantity(quantity, places)
    return data


def connect(interface_type, maps, actuator, joint):
    """Return a new interface with one handle, `t`."""
    interface = interface_type()
    interface.connect("t", maps, actuator, joint)
    return interface


def build(case):
    """Build the interface whose handle the text of a recorded case describes."""
    name, what = case.split(": ")
    size = 2 if "differential" in what else 1
    maps = SimpleTransmission(2.0)
    if size == 2:
        maps = DifferentialTransmission([2.0, 2.0], [1.0, 1.0])
    sizes = {"actuator": size, "joint": size}
    for side in sizes:
        if re.search(f"empty {side}|both empty", what):
            sizes[side] = 0
        if f"{side} size mismatch" in what:
            sizes[side] = 2
        if f"with 1 {side}" in what:
            sizes[side] = 1
    actuator = fill(ActuatorData(), sizes["actuator"], slot="null actuator" not in what)
    joint = fill(JointData(), sizes["joint"], slot="null joint" not in what)
    interface_type = getattr(transmissions, name.replace("Handle", "Interface"))
    maps = None if "null transmission" in what else maps
    return connect(interface_type, maps, actuator, joint)


def test_handles_are_refused_and_accepted_as_recorded(cases):
    checked = 0
    for case in cases:
        if case["case"].startswith("Interface"):
            continue
        checked += 1
        if case["exception"] is None:
            build(case["case"]).propagate()
            continue
        with pytest.raises(TransmissionInterfaceError) as caught:
            build(case["case"])
        assert caught.value.message == case["exception"]["what"]
    assert checked > 40


@pytest.mark.parametrize("side", ["Actuator", "Joint"])
@pytest.mark.parametrize("quantity", ["absolute_position", "torque_sensor"])
def test_sensor_places_must_fit_too(side, quantity):
    data = {"Actuator": fill(ActuatorData(), 1), "Joint": fill(JointData(), 1)}
    for places, reason in (
        ([([0.0], 0)] * 2, "size does not match"),
        ([None], "contains null pointers"),
    ):
        setattr(data[side], quantity, places)
        with pytest.raises(TransmissionInterfaceError, match=reason):
            connect(
                ActuatorToJointStateInterface, SimpleTransmission(2.0), *data.values()
            )


def places(*storages):
    return [[(storage, 0)] for storage in storages]


def test_state_is_carried_with_encoder_and_torque_sensor():
    actuator = [[8.0], [6.0], [4.0], [2.0], [1.0]]
    joint = [[0.0] for _ in actuator]
    interface = connect(
        ActuatorToJointStateInterface,
        SimpleTransmission(2.0, 0.5),
        ActuatorData(*places(*actuator)),
        JointData(*places(*joint)),
    )
    interface.propagate()
    assert joint == [[4.5], [3.0], [8.0], [1.5], [2.0]]


def test_joint_state_is_carried_back_without_sensors():
    actuator = [[0.0] for _ in range(5)]
    joint = [[4.5], [3.0], [8.0], [1.5], [2.0]]
    interface = connect(
        JointToActuatorStateInterface,
        SimpleTransmission(2.0, 0.5),
        ActuatorData(*places(*actuator)),
        JointData(*places(*joint)),
    )
    interface.propagate()
    assert actuator == [[8.0], [6.0], [4.0], [0.0], [0.0]]
