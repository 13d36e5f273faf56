"""Kinematics and dynamics of the arm against Pinocchio, on the same URDF.

Pinocchio reads the URDF with a parser of its own and computes with other algorithms
than MuJoCo, so both are wrong in the same way in nothing but the URDF itself. 1e-9 is
what rounding leaves of numbers up to 100 (Nm, kg m^2) in double precision, with room.
"""

from dataclasses import dataclass, replace
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.franka.franka_model import Frame
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.rigid_body import RigidBody, combine_bodies
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.end_effector import end_effector_of
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.urdf_loader import load_urdf

STATES = 500
TOLERANCE = 1e-9
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
GRAVITIES = ([0.0, 0.0, -9.81], [0.0, 0.0, 0.0], [9.81, 0.0, 0.0], [-3.0, 5.0, 7.0])


@dataclass(frozen=True)
class Case:
    """One random state: joints, load at the flange, frames and gravity."""

    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    load: RigidBody
    F_T_EE: pin.SE3
    EE_T_K: pin.SE3
    gravity: list[float]


@pytest.fixture(scope="module")
def description() -> RobotFiles:
    return load_robot_files("example-robot-data:panda")


@pytest.fixture(scope="module")
def model(description: RobotFiles) -> ArmModel:
    return ArmModel(description)


@pytest.fixture(scope="module")
def arm(description: RobotFiles) -> pin.Model:
    """Return Pinocchio's model of the links 0 to 8, without hand."""
    root = ElementTree.fromstring(description.xml)
    kept = {f"panda_link{number}" for number in range(9)}
    for element in list(root):
        if element.tag == "link" and element.get("name") not in kept:
            root.remove(element)
        if element.tag == "joint":
            child = element.find("child")
            assert child is not None
            if child.get("link") not in kept:
                root.remove(element)
    built = pin.buildModelFromXML(ElementTree.tostring(root, encoding="unicode"))
    assert list(built.names)[1:] == JOINTS
    return built


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    generator = np.random.default_rng(2024)
    limits = PANDA_LIMITS
    return [
        Case(
            generator.uniform(limits.lower, limits.upper),
            generator.uniform(-1.0, 1.0, 7) * limits.velocity,
            generator.uniform(-1.0, 1.0, 7) * limits.acceleration,
            random_load(generator) if number % 10 else RigidBody(),
            random_pose(generator),
            random_pose(generator),
            [*GRAVITIES, generator.uniform(-10.0, 10.0, 3).tolist()][number % 5],
        )
        for number in range(STATES)
    ]


def random_pose(generator: np.random.Generator) -> pin.SE3:
    vector = generator.normal(size=4)
    w, x, y, z = vector / np.linalg.norm(vector)
    return pin.SE3(pin.Quaternion(w, x, y, z).matrix(), generator.uniform(-0.3, 0.3, 3))


def random_load(generator: np.random.Generator) -> RigidBody:
    """Return a body of a few points, so that its inertia is a possible one."""
    masses = generator.uniform(0.05, 0.8, 5)
    points = generator.uniform(-0.2, 0.2, (5, 3))
    center = masses @ points / masses.sum()
    inertia = sum(
        mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
        for mass, offset in zip(masses, points - center, strict=True)
    )
    return RigidBody(float(masses.sum()), tuple(center), tuple(inertia.ravel()))


def loaded(arm: pin.Model, load: RigidBody) -> pin.Model:
    """Return a copy of Pinocchio's arm with a body fixed to its flange."""
    result = pin.Model(arm)
    flange = result.frames[result.getFrameId("panda_link8")]
    inertia = np.reshape(load.inertia, (3, 3))
    body = pin.Inertia(load.mass, np.array(load.center_of_mass), inertia)
    result.appendBodyToJoint(flange.parentJoint, body, flange.placement)
    return result


def flat(pose: pin.SE3) -> list[float]:
    """Return a pose as libfranka has it, column by column."""
    return pose.homogeneous.T.ravel().tolist()


def explicit(case: Case) -> tuple[list[float], float, list[float]]:
    """Return the load in the order of the model's arguments."""
    load = case.load
    return list(load.inertia), load.mass, list(load.center_of_mass)


def test_mass_agrees(model: ArmModel, arm: pin.Model, cases: list[Case]) -> None:
    for case in cases:
        theirs = loaded(arm, case.load)
        expected = pin.crba(theirs, theirs.createData(), case.q)
        expected = np.triu(expected) + np.triu(expected, 1).T
        ours = model.mass(case.q.tolist(), *explicit(case))
        np.testing.assert_allclose(
            np.reshape(ours, (7, 7)), expected, rtol=0.0, atol=TOLERANCE
        )


def test_coriolis_agrees(model: ArmModel, arm: pin.Model, cases: list[Case]) -> None:
    for case in cases:
        theirs = loaded(arm, case.load)
        matrix = pin.computeCoriolisMatrix(theirs, theirs.createData(), case.q, case.dq)
        ours = model.coriolis(case.q.tolist(), case.dq.tolist(), *explicit(case))
        np.testing.assert_allclose(ours, matrix @ case.dq, rtol=0.0, atol=TOLERANCE)


def test_gravity_agrees(model: ArmModel, arm: pin.Model, cases: list[Case]) -> None:
    for case in cases:
        theirs = loaded(arm, case.load)
        theirs.gravity.linear = np.array(case.gravity)
        expected = pin.computeGeneralizedGravity(theirs, theirs.createData(), case.q)
        _, mass, center = explicit(case)
        ours = model.gravity(case.q.tolist(), mass, center, case.gravity)
        np.testing.assert_allclose(ours, expected, rtol=0.0, atol=TOLERANCE)


def test_torques_of_a_motion_agree(
    description: RobotFiles, arm: pin.Model, cases: list[Case]
) -> None:
    dynamics = FrankaDynamics(description)
    for case in cases:
        theirs = loaded(arm, case.load)
        theirs.gravity.linear = np.array(case.gravity)
        expected = pin.rnea(theirs, theirs.createData(), case.q, case.dq, case.ddq)
        ours = dynamics.torques(
            case.q.tolist(),
            case.dq.tolist(),
            case.ddq.tolist(),
            case.load,
            case.gravity,
        )
        np.testing.assert_allclose(ours, expected, rtol=0.0, atol=TOLERANCE)


@pytest.mark.parametrize("frame", list(Frame))
def test_pose_and_jacobians_agree(
    model: ArmModel, arm: pin.Model, cases: list[Case], frame: Frame
) -> None:
    for case in cases:
        theirs, index = with_frame(arm, frame, case)
        data = theirs.createData()
        pin.computeJointJacobians(theirs, data, case.q)
        pose = pin.updateFramePlacement(theirs, data, index)
        world = pin.getFrameJacobian(theirs, data, index, pin.LOCAL_WORLD_ALIGNED)
        local = pin.getFrameJacobian(theirs, data, index, pin.LOCAL)
        arguments = (frame, case.q.tolist(), flat(case.F_T_EE), flat(case.EE_T_K))
        for ours, expected in (
            (model.pose(*arguments), pose.homogeneous),
            (model.zero_jacobian(*arguments), world),
            (model.body_jacobian(*arguments), local),
        ):
            np.testing.assert_allclose(
                ours, expected.T.ravel(), rtol=0.0, atol=TOLERANCE
            )


def with_frame(arm: pin.Model, frame: Frame, case: Case) -> tuple[pin.Model, int]:
    """Return Pinocchio's arm with a frame, and the frame's index."""
    if frame.value < Frame.FLANGE.value:
        return arm, arm.getFrameId(f"panda_link{frame.value + 1}")
    index = arm.getFrameId("panda_link8")
    if frame is Frame.FLANGE:
        return arm, index
    result = pin.Model(arm)
    flange = result.frames[index]
    placement = flange.placement * case.F_T_EE
    if frame is Frame.STIFFNESS:
        placement = placement * case.EE_T_K
    added = pin.Frame(
        "tool", flange.parentJoint, index, placement, pin.FrameType.OP_FRAME
    )
    return result, result.addFrame(added)


def test_arm_with_its_hand_is_the_arm_with_that_load(
    description: RobotFiles, model: ArmModel, cases: list[Case]
) -> None:
    width = 0.08
    whole = pin.buildModelFromXML(description.xml)
    fingers = [whole.getJointId(f"panda_finger_joint{number}") for number in (1, 2)]
    pose = pin.neutral(whole)
    for finger in fingers:
        pose[whole.joints[finger].idx_q] = width / 2.0
    with_hand = pin.buildReducedModel(whole, fingers, pose)
    hand = end_effector_of(load_urdf(description), "panda_", width)
    for case in cases:
        theirs = loaded(with_hand, case.load)
        both = replace(case, load=combine_bodies(hand, case.load))
        expected = pin.crba(theirs, theirs.createData(), case.q)
        expected = np.triu(expected) + np.triu(expected, 1).T
        ours = model.mass(case.q.tolist(), *explicit(both))
        np.testing.assert_allclose(
            np.reshape(ours, (7, 7)), expected, rtol=0.0, atol=TOLERANCE
        )
        expected = pin.computeGeneralizedGravity(theirs, theirs.createData(), case.q)
        _, mass, center = explicit(both)
        ours = model.gravity(case.q.tolist(), mass, center)
        np.testing.assert_allclose(ours, expected, rtol=0.0, atol=TOLERANCE)


def test_simulated_arm_agrees_with_the_model_of_pinocchio(
    description: RobotFiles, arm: pin.Model, cases: list[Case]
) -> None:
    """The world moves the arm that the model describes, its rotors apart."""
    simulation = simulate([ArmPlacement("panda", description)])
    world = simulation.world
    joints = world.joints(JOINTS)
    hand = end_effector_of(load_urdf(description), "panda_", 0.08)
    theirs = loaded(arm, hand)
    for case in cases:
        world.reset(dict(zip(JOINTS, case.q.tolist(), strict=True)))
        expected = pin.computeGeneralizedGravity(theirs, theirs.createData(), case.q)
        np.testing.assert_allclose(
            joints.read_compensation(), expected, rtol=0.0, atol=TOLERANCE
        )
        inertia = np.diag(pin.crba(theirs, theirs.createData(), case.q))
        np.testing.assert_allclose(
            joints.read_inertia(), inertia + joints.armature, rtol=0.0, atol=TOLERANCE
        )
