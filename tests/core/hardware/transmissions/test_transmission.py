"""The maps answer as recorded, undo each other, and preserve power.

Some are computed by hand: one actuator and one joint, and a differential of two.
"""

import gzip
import json
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

from station.core.hardware.transmissions import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    SimpleTransmission,
    TransmissionInterfaceError,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmissions.json.gz"
KINDS = ("simple", "differential", "four_bar_linkage")
reductions = st.floats(0.1, 200.0) | st.floats(-200.0, -0.1)
values = st.floats(-100.0, 100.0)
pairs = st.tuples(values, values).map(list)
pairs_of_reductions = st.tuples(reductions, reductions).map(list)
simple = st.builds(SimpleTransmission, reductions, values)
differential = st.builds(
    DifferentialTransmission, pairs_of_reductions, pairs_of_reductions, pairs
)
four_bar_linkage = st.builds(
    FourBarLinkageTransmission, pairs_of_reductions, pairs_of_reductions, pairs
)
CLOSE = {"rel": 1e-9, "abs": 1e-6}  # reductions up to 200 amplify rounding at 1e-13


@pytest.fixture(scope="module")
def recorded():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)


def make(kind, parameters):
    if kind == "simple":
        numbers = (parameters["reduction"], parameters.get("offset", 0.0))
        return SimpleTransmission(*map(float, numbers))
    names = ("actuator_reduction", "joint_reduction", "joint_offset")
    lists = [parameters[name] for name in names if parameters[name] != "default"]
    if kind == "four_bar_linkage":
        return FourBarLinkageTransmission(*lists)
    key = "ignore_transmission_for_absolute_encoders"
    return DifferentialTransmission(*lists, **{key: parameters.get(key, False)})


def exact(numbers):
    return [repr(float(number)) for number in numbers]  # tells -0.0 from 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_maps_equal_the_recorded_ones_bit_by_bit(kind, recorded):
    for parameters in recorded[kind]:
        transmission = make(kind, parameters)
        for sample in parameters["samples"]:
            for direction, source, target in (
                ("actuator_to_joint", "act_in", "jnt_out"),
                ("joint_to_actuator", "jnt_in", "act_out"),
            ):
                for quantity, given_values in sample[source].items():
                    function = getattr(transmission, f"{direction}_{quantity}")
                    result = function([float(value) for value in given_values])
                    assert exact(result) == exact(sample[target][quantity])


def test_constructors_refuse_what_the_original_refuses(recorded):
    for case in recorded["constructor_cases"]:
        if case["exception"] is None:
            make(case["case"], case["args"])
            continue
        with pytest.raises(TransmissionInterfaceError) as caught:
            make(case["case"], case["args"])
        assert caught.value.message == case["exception"]["what"]
        assert caught.value.remedy


@settings(derandomize=True)
@given(simple | differential | four_bar_linkage, pairs)
def test_round_trips_are_identities(transmission, pair):
    start = pair[: transmission.num_joints]
    for quantity in ("position", "velocity", "effort"):
        to_actuator = getattr(transmission, f"joint_to_actuator_{quantity}")
        to_joint = getattr(transmission, f"actuator_to_joint_{quantity}")
        assert to_joint(to_actuator(start)) == pytest.approx(start, **CLOSE)
        assert to_actuator(to_joint(start)) == pytest.approx(start, **CLOSE)


def power(effort, velocity):
    return sum(f * v for f, v in zip(effort, velocity, strict=True))


@settings(derandomize=True)
@given(simple | differential, pairs, pairs)
def test_power_in_equals_power_out(transmission, effort, velocity):
    effort = effort[: transmission.num_actuators]
    velocity = velocity[: transmission.num_actuators]
    joint_power = power(
        transmission.actuator_to_joint_effort(effort),
        transmission.actuator_to_joint_velocity(velocity),
    )
    # products of the other actuator's terms cancel: their size bounds the rounding
    scale = (1e-9 * 200.0**2) * (1.0 + power(map(abs, effort), map(abs, velocity)))
    assert joint_power == pytest.approx(power(effort, velocity), abs=1e-6 + scale)


@settings(derandomize=True)
@given(four_bar_linkage, pairs, pairs)
def test_four_bar_linkage_gains_the_power_its_formulas_say(transmission, f, v):
    a, j = transmission.actuator_reduction, transmission.joint_reduction
    gain = f[0] * v[0] - f[1] * v[0] * a[1] / (j[0] * a[0])
    gain -= f[0] * v[1] * j[0] * a[0] / a[1]
    joint_power = power(
        transmission.actuator_to_joint_effort(f),
        transmission.actuator_to_joint_velocity(v),
    )
    terms = abs(gain) + abs(power(f, v)) + abs(joint_power) + 1e8
    assert joint_power - power(f, v) == pytest.approx(gain, abs=1e-9 * terms)


@settings(derandomize=True)
@given(simple, values)
def test_simple_transmission_multiplies_effort_and_divides_velocity(transmission, x):
    n = transmission.reduction
    assert transmission.actuator_to_joint_effort([x]) == [x * n]
    assert transmission.actuator_to_joint_velocity([x]) == [x / n]


def test_reduction_slows_the_joint_and_multiplies_its_effort():
    transmission = SimpleTransmission(50.0, joint_offset=0.5)
    assert transmission.actuator_to_joint_position([100.0]) == [2.5]
    assert transmission.actuator_to_joint_velocity([-50.0]) == [-1.0]
    assert transmission.actuator_to_joint_effort([2.0]) == [100.0]


def test_negative_reduction_turns_the_joint_the_other_way():
    transmission = SimpleTransmission(-2.0)
    assert transmission.joint_to_actuator_position([3.0]) == [-6.0]
    assert transmission.joint_to_actuator_effort([4.0]) == [-2.0]


def test_sensors_are_mapped_like_position_and_effort():
    transmission = SimpleTransmission(4.0, joint_offset=1.0)
    assert transmission.actuator_to_joint_absolute_position([8.0]) == [3.0]
    assert transmission.actuator_to_joint_torque_sensor([2.0]) == [8.0]


WRIST = DifferentialTransmission([10.0, 10.0], [1.0, 2.0], [0.5, -0.5])


def test_equal_motion_turns_only_the_first_joint():
    assert WRIST.actuator_to_joint_velocity([20.0, 20.0]) == [2.0, 0.0]


def test_opposite_motion_turns_only_the_second_joint():
    assert WRIST.actuator_to_joint_velocity([20.0, -20.0]) == [0.0, 1.0]


def test_offsets_are_added_to_positions():
    assert WRIST.actuator_to_joint_position([0.0, 0.0]) == [0.5, -0.5]
    assert WRIST.joint_to_actuator_position([0.5, -0.5]) == [0.0, 0.0]


def test_both_actuators_bear_the_effort_of_one_joint():
    assert WRIST.joint_to_actuator_effort([40.0, 0.0]) == [2.0, 2.0]
    assert WRIST.joint_to_actuator_effort([0.0, 40.0]) == [1.0, -1.0]


def test_encoders_on_the_joints_are_exchanged_and_nothing_else():
    transmission = DifferentialTransmission(
        [10.0, 10.0], [1.0, 1.0], ignore_transmission_for_absolute_encoders=True
    )
    assert transmission.actuator_to_joint_absolute_position([1.0, 2.0]) == [2.0, 1.0]


@pytest.mark.parametrize("sizes", [(1, 2, 2), (2, 3, 2), (2, 2, 0)])
def test_other_than_two_values_are_refused(sizes):
    with pytest.raises(
        TransmissionInterfaceError, match="a differential transmission must have size 2"
    ):
        DifferentialTransmission(*([1.0] * size for size in sizes))
