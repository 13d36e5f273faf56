"""Limits come out of a URDF as recorded; what cannot be right is refused."""

import gzip
import json
import sysconfig
from pathlib import Path

import pytest

from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.hardware.limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
    joint_limits_from_urdf,
    soft_joint_limits_from_urdf,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "joint_limits_urdf.json.gz"
PANDA = (
    Path(sysconfig.get_path("purelib"))
    / "cmeel.prefix/share/example-robot-data/robots/panda_description/urdf/panda.urdf"
)
EARLIER = JointLimits(-9.0, 9.0, 99.0, 98.0, 97.0, 96.0, angle_wraparound=True)
QUANTITIES = ("velocity", "acceleration", "jerk", "effort")


@pytest.fixture(scope="module")
def cases():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["cases"]


def read_limits(recorded):
    found = {"angle_wraparound": recorded["angle_wraparound"]}
    if recorded["has_position_limits"]:
        found["min_position"] = recorded["min_position"]
        found["max_position"] = recorded["max_position"]
    for quantity in QUANTITIES:
        if recorded[f"has_{quantity}_limits"]:
            found[f"max_{quantity}"] = recorded[f"max_{quantity}"]
    return JointLimits(**found)


def read_joints(urdf):
    text = urdf if urdf.startswith("<") else PANDA.read_text()
    return parse_urdf(text).joints


def test_limits_are_those_recorded(cases):
    checked = 0
    for case in cases:
        joints = read_joints(case["urdf"]) if case["urdf_parse_ok"] else {}
        earlier = EARLIER if case["prefilled"] else None
        for recorded in case["joints"]:
            checked += 1
            joint = joints[recorded["joint"]]
            expected = recorded["getJointLimits"] and read_limits(recorded["limits"])
            assert joint_limits_from_urdf(joint, earlier) == (expected or None)
            soft = recorded["soft_limits"]
            expected = recorded["getSoftJointLimits"] and SoftJointLimits(**soft)
            assert soft_joint_limits_from_urdf(joint) == (expected or None)
    assert checked > 30


def test_descriptions_that_the_original_discards_are_refused(cases):
    for case in cases:
        if case["urdf_parse_ok"]:
            continue
        with pytest.raises(RobotDescriptionError, match="Joint 'j'"):
            read_joints(case["urdf"])


def test_inverted_limits_are_read_but_not_valid():
    joint = read_joints(
        '<robot name="r"><link name="a"/><link name="b"/>'
        '<joint name="elbow" type="revolute"><parent link="a"/><child link="b"/>'
        '<limit lower="1" upper="-1" velocity="1" effort="1"/></joint></robot>'
    )["elbow"]
    limits = joint_limits_from_urdf(joint)
    with pytest.raises(JointLimitsError, match=r"'elbow' .* from 1\.0 to -1\.0"):
        limits.validate("elbow")
