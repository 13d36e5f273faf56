"""The parser finds and skips what the original does, and says why."""

import gzip
import json
from pathlib import Path

import pytest

from station.core.errors import RobotDescriptionError
from station.core.hardware.transmissions import TransmissionParser

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmission_urdf.json.gz"
JOINT = '<joint name="j"><hardwareInterface>i</hardwareInterface></joint>'
ACTUATOR = '<actuator name="a"/>'


@pytest.fixture(scope="module")
def files():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["files"]


def test_parser_finds_and_skips_what_the_original_does(files):
    parser = TransmissionParser()
    for file in files:
        if file["parse_result"] is not True:
            with pytest.raises(RobotDescriptionError, match="Invalid robot descrip"):
                parser.parse(file["urdf"])
            continue
        infos = parser.parse(file["urdf"])
        assert [f"[ERROR] {p}" for p in parser.problems] == file["parse_log"]
        for info, recorded in zip(infos, file["transmissions"], strict=True):
            assert (info.name, info.type) == (recorded["name"], recorded["type"])
            for joint, expected in zip(info.joints, recorded["joints"], strict=True):
                assert (joint.name, joint.role) == (expected["name"], expected["role"])
                names = tuple(expected["hardware_interfaces"])
                assert joint.hardware_interfaces == names
            names = [actuator["name"] for actuator in recorded["actuators"]]
            assert [actuator.name for actuator in info.actuators] == names


@pytest.mark.parametrize(
    ("element", "problem"),
    [
        ("<transmission/>", "No name attribute specified for transmission."),
        ('<transmission name=""/>', "Empty name attribute specified for transmission."),
        ('<transmission name="t"/>', "No type element found in transmission 't'."),
        (
            '<transmission name="t"><type/></transmission>',
            "Skipping empty type element in transmission 't'.",
        ),
    ],
)
def test_transmission_without_name_or_type_is_skipped(element, problem):
    parser = TransmissionParser()
    assert parser.parse(f"<robot>{element}</robot>") == []
    assert parser.problems == [problem]


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ('<joint name=""/>' + ACTUATOR, "Empty name attribute specified for joint."),
        ("<joint/>" + JOINT, "No name attribute specified for joint."),
        (
            '<joint name="j"><hardwareInterface/></joint>' + ACTUATOR,
            "No valid hardware interface element found in joint 'j'.",
        ),
        (JOINT + "<actuator/>", "No name attribute specified for actuator."),
        (JOINT + '<actuator name=""/>', "Empty name attribute specified for actuator."),
        (JOINT, "Failed to load actuators for transmission 't'."),
    ],
)
def test_transmission_without_usable_members_is_skipped(content, problem):
    parser = TransmissionParser()
    urdf = (
        f'<robot><transmission name="t"><type>x</type>{content}</transmission></robot>'
    )
    assert parser.parse(urdf) == []
    assert parser.problems[0] == problem


def test_problems_are_those_of_the_last_document():
    parser = TransmissionParser()
    parser.parse("<robot><transmission/></robot>")
    parser.parse("<robot/>")
    assert parser.problems == []
