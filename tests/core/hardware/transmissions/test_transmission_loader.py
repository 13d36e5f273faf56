"""Descriptions become transmissions with the recorded parameters, or are refused."""

import gzip
import json
from pathlib import Path

import pytest

from station.core.hardware.transmissions import (
    FourBarLinkageTransmission,
    SimpleTransmission,
    TransmissionInterfaceError,
    TransmissionParser,
    load_transmission,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmission_urdf.json.gz"
DIFFERENTIAL = "transmission_interface/DifferentialTransmission"


@pytest.fixture(scope="module")
def files():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["files"]


def same(number, recorded):
    return repr(float(number)) == repr(float(recorded))


def parse(kind, content):
    (info,) = TransmissionParser().parse(
        f'<robot><transmission name="t"><type>{kind}</type>{content}'
        "</transmission></robot>"
    )
    return info


def describe_pair(
    kind=DIFFERENTIAL,
    roles=("joint1", "joint2"),
    actuator="<role>actuator2</role>",
    extra="",
):
    """Describe a transmission of two joints, and actuators in the other order."""
    joints = "".join(
        f'<joint name="{name}"><role>{role}</role><mechanicalReduction>2'
        f"</mechanicalReduction><offset>0.5</offset>{extra}"
        "<hardwareInterface>i</hardwareInterface></joint>"
        for name, role in zip(("roll", "pitch"), roles, strict=True)
    )
    first = f"{actuator}<mechanicalReduction>5</mechanicalReduction>"
    second = "<role>actuator1</role><mechanicalReduction>4</mechanicalReduction>"
    actuators = f'<actuator name="a">{first}</actuator><actuator name="b">{second}'
    return parse(kind, f"{joints}{actuators}</actuator>")


def test_transmissions_get_the_recorded_parameters(files):
    for file in files:
        if file["parse_result"] is not True:
            continue
        infos = TransmissionParser().parse(file["urdf"])
        for info, recorded in zip(infos, file["transmissions"], strict=True):
            expected = recorded["plugin_load"]
            if not expected["accepted"]:
                with pytest.raises(TransmissionInterfaceError) as caught:
                    load_transmission(info)
                assert f"[ERROR] {caught.value.message}" in expected["log"]
                continue
            found = load_transmission(info)
            parameters = expected["transmission"]
            assert same(found.reduction, parameters["actuator_reduction"])
            assert same(found.joint_offset, parameters["joint_offset"])


def test_roles_order_the_parameters_but_not_the_members():
    info = describe_pair()
    assert load_transmission(info).actuator_reduction == [4.0, 5.0]
    assert [actuator.name for actuator in info.actuators] == ["a", "b"]


def test_four_bar_linkage_is_loaded_with_all_its_parameters():
    kind = "transmission_interface/FourBarLinkageTransmission"
    transmission = load_transmission(describe_pair(kind))
    assert isinstance(transmission, FourBarLinkageTransmission)
    assert transmission.joint_reduction == [2.0, 2.0]
    assert transmission.joint_offset == [0.5, 0.5]


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"roles": ("joint1", "joint1")}, "different roles. Both specify 'joint1'"),
        ({"roles": ("joint1", "")}, "'pitch' of transmission 't' specifies an empty"),
        ({"roles": ("joint1", "x")}, "Got 'x', expected 'joint1' or 'joint2'"),
        ({"actuator": ""}, "'a' of transmission 't' does not specify the required"),
    ],
)
def test_wrong_roles_are_refused_with_the_member(wrong, reason):
    with pytest.raises(TransmissionInterfaceError) as caught:
        load_transmission(describe_pair(**wrong))
    assert reason in caught.value.message


def test_encoders_on_the_joints_are_not_mapped_if_both_joints_say_so():
    info = describe_pair(extra="<ignoreTransmissionAbsoluteEncoder/>")
    transmission = load_transmission(info)
    assert transmission.actuator_to_joint_absolute_position([1.0, 2.0]) == [2.0, 1.0]


JOINT = '<joint name="j"><hardwareInterface>i</hardwareInterface></joint>'
SIMPLE = "transmission_interface/SimpleTransmission"


@pytest.mark.parametrize(
    ("actuators", "reason"),
    [
        ('<actuator name="a"/>', "does not specify the required <mechanicalReduction>"),
        (
            '<actuator name="a"><mechanicalReduction> 0 </mechanicalReduction>'
            "</actuator>",
            "Failed to construct transmission 't' of type "
            "'transmission_interface::SimpleTransmission'. "
            "Transmission reduction ratio cannot be zero.",
        ),
        ('<actuator name="a"/><actuator name="b"/>', "Expected 1 actuators, got 2."),
    ],
)
def test_wrong_actuators_are_refused(actuators, reason):
    with pytest.raises(TransmissionInterfaceError) as caught:
        load_transmission(parse(SIMPLE, JOINT + actuators))
    assert reason in caught.value.message


def test_unknown_type_is_refused_with_the_known_ones():
    info = parse("own/Belt", JOINT + '<actuator name="a"/>')
    with pytest.raises(TransmissionInterfaceError) as caught:
        load_transmission(info)
    assert "'t'. Unsupported type 'own/Belt'" in caught.value.message
    assert SIMPLE in caught.value.remedy


def test_own_type_is_used():
    info = parse("own/Belt", JOINT + '<actuator name="a"/>')
    types = {"own/Belt": lambda found: SimpleTransmission(float(len(found.joints)))}
    assert load_transmission(info, types).reduction == 1.0
