"""The URDF for clients, as Pinocchio and libfranka's own formula read it.

1e-9 is what rounding leaves of numbers up to 100 (Nm, kg m^2), with room.
"""

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import RobotDescriptionError
from station.core.franka.franka_model import Frame
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.arm.arm_limits import LIMITS_OF_ARM
from station.hw.franka.fci.server.robot_model import write_robot_model
from station.hw.franka.simulated.arm_model import ArmModel

PANDA = "example-robot-data:panda"
TOLERANCE = 1e-9
NO_LOAD = ([0.0] * 9, 0.0, [0.0] * 3)
LOAD = ([0.02, 0.001, 0.002, 0.001, 0.03, 0.003, 0.002, 0.003, 0.04], 1.7, [0.05, 0, 1])
IDENTITY = np.eye(4).ravel().tolist()


class Written:
    """One kind of arm: its text, Pinocchio's model of the text, and ours."""

    def __init__(self, arm: str) -> None:
        self.arm, self.limits = arm, LIMITS_OF_ARM[arm]
        self.description = load_arm_description(PANDA, self.limits)
        self.text = write_robot_model(self.description, self.limits, arm)
        self.theirs = pin.buildModelFromXML(self.text)
        self.ours = ArmModel(self.description)
        generator = np.random.default_rng(18)
        self.states = [
            (
                generator.uniform(self.limits.lower, self.limits.upper),
                generator.uniform(-1.0, 1.0, 7) * self.limits.velocity,
            )
            for _ in range(50)
        ]


@pytest.fixture(scope="module", params=sorted(LIMITS_OF_ARM))
def written(request: pytest.FixtureRequest) -> Written:
    return Written(request.param)


def carrying(model: pin.Model, load: tuple[list[float], float, list[float]]):
    """Return a copy with a load at `link8`, as libfranka adds the one of the state."""
    inertia, mass, center = load
    result = pin.Model(model)
    flange = result.frames[result.getFrameId("link8")]
    body = pin.Inertia(mass, np.array(center, float), np.reshape(inertia, (3, 3)))
    result.appendBodyToJoint(flange.parentJoint, body, flange.placement)
    return result


def test_names_are_those_that_libfranka_looks_for(written):
    names = [frame.name for frame in written.theirs.frames]
    assert [name for name in names if name.startswith("link")] == [
        f"link{number}" for number in range(9)
    ]
    assert list(written.theirs.names)[1:] == [f"joint{n}" for n in range(1, 8)]
    # The last frame is taken for the flange, and no name of the robot for a mobile one.
    assert names[-1] == "link8"
    root = ElementTree.fromstring(written.text)
    assert root.get("name") == written.arm
    assert root.find("joint[@name='joint8']").get("type") == "fixed"
    assert not list(root.iter("mesh"))


@pytest.mark.parametrize("load", [NO_LOAD, LOAD], ids=["bare", "loaded"])
def test_dynamics_are_those_of_our_model(written, load):
    theirs = carrying(written.theirs, load)
    data = theirs.createData()
    inertia, mass, center = load
    for q, dq in written.states:
        expected = pin.crba(theirs, data, q)
        expected = np.triu(expected) + np.triu(expected, 1).T
        found = np.reshape(written.ours.mass(q, inertia, mass, center), (7, 7))
        assert np.abs(found - expected).max() < TOLERANCE
        expected = pin.computeCoriolisMatrix(theirs, data, q, dq) @ dq
        found = written.ours.coriolis(q, dq, inertia, mass, center)
        assert np.abs(found - expected).max() < TOLERANCE
        expected = pin.computeGeneralizedGravity(theirs, data, q)
        found = written.ours.gravity(q, mass, center)
        assert np.abs(found - expected).max() < TOLERANCE


def test_frames_are_where_ours_are(written):
    theirs, data = written.theirs, written.theirs.createData()
    for q, _ in written.states:
        pin.framesForwardKinematics(theirs, data, q)
        for number, frame in enumerate(list(Frame)[:8], start=1):
            pose = data.oMf[theirs.getFrameId(f"link{number}")].homogeneous
            ours = written.ours.pose(frame, q, IDENTITY, IDENTITY)
            assert np.abs(np.reshape(ours, (4, 4)).T - pose).max() < TOLERANCE


def test_velocity_limits_are_those_that_the_arm_keeps(written):
    root, generator = ElementTree.fromstring(written.text), np.random.default_rng(3)
    for i in range(7):
        joint = root.find(f"joint[@name='joint{i + 1}']")
        told = dict(joint.find("limit").items())
        told |= joint.find("position_based_velocity_limits").items()
        value = {name: float(number) for name, number in told.items()}
        o, d = value["velocity_offset"], value["deceleration_limit"]
        assert value["effort"] == written.limits.torque[i]
        lower, upper = written.limits.lower[i], written.limits.upper[i]
        for q in generator.uniform(lower, upper, 50):
            up = np.sqrt(max(0.0, 2.0 * d * (value["upper"] - q))) - o
            down = np.sqrt(max(0.0, 2.0 * d * (q - value["lower"]))) - o
            expected = (
                max(-value["velocity"], min(0.0, -down)),
                min(value["velocity"], max(0.0, up)),
            )
            assert written.limits.velocity_range(i, q) == pytest.approx(
                expected, abs=1e-12
            )


def test_robot_that_is_no_franka_arm_is_refused():
    with pytest.raises(RobotDescriptionError, match="is no Franka arm"):
        write_robot_model(
            load_robot_files("example-robot-data:ur5"), LIMITS_OF_ARM["fr3"], "fr3"
        )
