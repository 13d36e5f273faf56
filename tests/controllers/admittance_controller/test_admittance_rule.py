"""The rule against ros2_controllers' formulas, computed with matrices, and both modes.

Source: ros2_controllers@6.x admittance_controller/admittance_rule_impl.hpp.
"""

import numpy as np
import pytest
from hypothesis import given

from station.controllers.admittance_controller.admittance_rule import AdmittanceRule
from station.core.numerics.arm_chain import JointChain
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both, sibling
from tests.core.numerics.test_joint_chain import pose_of

SIZE = 6
RNG = np.random.default_rng(8)
ORIGINS = [pose_of(RNG.normal(size=3), 0.3 * RNG.normal(size=3)) for _ in range(7)]
AXES = np.array([axis / np.linalg.norm(axis) for axis in RNG.normal(size=(6, 3))])
TOOL = pose_of([0.2, -0.4, 0.1], [0.0, 0.05, 0.1])
MASS = np.array([3.0, 4.0, 5.0, 0.1, 0.2, 0.3])
STIFFNESS = np.array([200.0, 300.0, 400.0, 10.0, 20.0, 30.0])
DAMPING = 2 * 0.8 * np.sqrt(MASS * STIFFNESS)
SELECTED = np.array([1.0, 0.0, 1.0, 1.0, 1.0, 0.0])
CENTRE, WEIGHT = np.array([0.01, 0.02, 0.1]), np.array([0.0, 0.0, -12.0])
ALPHA, JOINT_DAMPING, SHARE, PERIOD = 0.01, 5.0, 0.05, 0.001


def chain(module=None, end=None):
    kind = JointChain if module is None else sibling(module, "arm_chain").JointChain
    poses = ORIGINS if end is None else [*ORIGINS[:-1], ORIGINS[-1] @ end]
    flat = np.concatenate([pose.T.ravel() for pose in poses]).tolist()
    return kind(SIZE, flat, AXES.ravel().tolist(), [1.0] * 6, range(6))


def rule(module=None):
    kind = AdmittanceRule if module is None else module.AdmittanceRule
    made = kind(SIZE, chain(module), chain(module), chain(module, TOOL), chain(module))
    put(made.weight, WEIGHT)
    put(made.centre_of_gravity, CENTRE)
    put(made.selected, SELECTED)
    put(made.inverse_mass, 1.0 / MASS)
    put(made.damping, DAMPING)
    put(made.stiffness, STIFFNESS)
    made.smoothing, made.inverse_damping = SHARE, ALPHA
    made.joint_damping = JOINT_DAMPING
    return made


def place(q, end=None):
    pose = ORIGINS[0]
    for axis, position, origin in zip(AXES, q, ORIGINS[1:], strict=True):
        pose = pose @ pose_of(position * axis, [0, 0, 0]) @ origin
    return pose if end is None else pose @ end


def jacobian(q):
    columns = []
    for step in 1e-6 * np.eye(SIZE):
        change = (place(q + step) - place(q - step)) / 2e-6
        turned = change[:3, :3] @ place(q)[:3, :3].T
        columns.append([*change[:3, 3], turned[2, 1], turned[0, 2], turned[1, 0]])
    return np.array(columns).T


def rotation_vector(matrix):
    angle = np.arccos((np.trace(matrix) - 1) / 2)
    skew = (matrix - matrix.T) / (2 * np.sin(angle))
    return angle * np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


class Expected:
    """One cycle after the other, as the original's code has it."""

    def __init__(self):
        self.force, self.velocity = np.zeros(6), np.zeros(6)
        self.dq, self.q = np.zeros(SIZE), np.zeros(SIZE)

    def step(self, measured, q, q_ref):
        sensor = place(q)
        rotation = sensor[:3, :3]
        force = rotation @ measured[:3] - WEIGHT
        torque = rotation @ measured[3:] - np.cross(rotation @ CENTRE, WEIGHT)
        new = np.array([*force, *torque])
        self.force = SHARE * new + (1 - SHARE) * self.force
        control = place(q, TOOL)[:3, :3]
        turn = np.kron(np.eye(2), control)
        wanted = place(q_ref)
        turned = rotation_vector(rotation @ wanted[:3, :3].T)
        error = np.array([*(sensor[:3, 3] - wanted[:3, 3]), *turned])
        selected = turn @ np.diag(SELECTED) @ turn.T @ self.force
        damping = turn @ np.diag(DAMPING) @ turn.T
        stiffness = turn @ np.diag(STIFFNESS) @ turn.T
        inverse_mass = turn @ np.diag(1.0 / MASS) @ turn.T
        pull = selected - damping @ self.velocity - stiffness @ error
        acceleration = inverse_mass @ pull
        matrix = jacobian(q)
        inverse = np.linalg.inv(matrix.T @ matrix + ALPHA * np.eye(SIZE)) @ matrix.T
        joints = inverse @ acceleration - JOINT_DAMPING * self.dq
        self.dq = self.dq + joints * PERIOD
        self.q = self.q + self.dq * PERIOD
        self.velocity = matrix @ self.dq


def test_twenty_cycles_are_those_of_the_formulas():
    own, expected = rule(), Expected()
    rng = np.random.default_rng(9)
    q_ref = rng.normal(size=SIZE)
    for _ in range(20):
        q = q_ref + 0.05 * rng.normal(size=SIZE)
        measured = 10.0 * rng.normal(size=6)
        put(own.wrench, measured)
        own.compute_motion(doubles(q), doubles(q_ref), PERIOD)
        expected.step(measured, q, q_ref)

    # The Jacobian of the expectation is one of finite differences.
    assert [*own.force] == pytest.approx(expected.force, abs=1e-10)
    assert [*own.positions] == pytest.approx(expected.q, rel=1e-6)
    assert [*own.velocities] == pytest.approx(expected.dq, rel=1e-6)
    assert [*own.velocity] == pytest.approx(expected.velocity, rel=1e-6)


def test_the_weight_of_the_tool_alone_is_no_force():
    own = rule()
    q = np.linspace(-1.0, 1.0, SIZE)
    inwards = place(q)[:3, :3].T
    torque = np.cross(CENTRE, inwards @ WEIGHT)
    put(own.wrench, [*(inwards @ WEIGHT), *torque])
    own.compute_motion(doubles(q), doubles(q), PERIOD)

    assert [*own.force] == pytest.approx(np.zeros(6), abs=1e-12)
    assert [*own.positions] == pytest.approx(np.zeros(6), abs=1e-15)


@needs_both
@given(arrays(6), arrays(6), arrays(6))
def test_both_modes_agree_bit_for_bit(wrench, q, q_ref):
    def scenario(module):
        own = rule(module)
        put(own.wrench, wrench)
        for _ in range(3):
            own.compute_motion(doubles(q), doubles(q_ref), PERIOD)
        return [*own.positions, *own.velocity, *own.force]

    assert_same("admittance_rule", scenario)
