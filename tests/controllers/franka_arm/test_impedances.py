"""The torques of an impedance against its formula, and both modes."""

import numpy as np
import pytest
from hypothesis import given

from station.controllers.franka_arm.impedances import (
    Friction,
    JointImpedance,
    PoseImpedance,
)
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both, numbers

JOINTS = 7
STIFFNESS = np.array([100.0, 200.0, 300.0, 10.0, 20.0, 30.0])


def impedance(turned=(0.0, 0.0, 0.0), moved=(0.0, 0.0, 0.0), largest=np.inf):
    """Return a deflected spring with its rest, Jacobian and matrix of damping."""
    rng = np.random.default_rng(7)
    q, dq = rng.normal(size=JOINTS), 0.1 * rng.normal(size=JOINTS)
    spring = PoseImpedance(
        doubles(q), doubles(dq), doubles([0.0] * JOINTS), np.inf, is_angle=True
    )
    spring.largest_force, spring.largest_torque = largest, np.inf
    put(spring.pose, np.eye(4).T.ravel())
    spring.start_at_rest(15.0)
    put(spring.axes, STIFFNESS)
    spring.slowing = 4.0
    jacobian, half = rng.normal(size=(6, JOINTS)), rng.normal(size=(6, 6))
    put(spring.jacobian, jacobian.T.ravel())
    put(spring.dampings, (half @ half.T).ravel())
    put(spring.coriolis, rng.normal(size=JOINTS))
    put(spring.rest, q + 0.3)
    x, y, z = turned
    pose = np.eye(4)
    pose[:3, :3] += [[0, -z, y], [z, 0, -x], [-y, x, 0]]  # small
    pose[:3, 3] = moved
    put(spring.pose, pose.T.ravel())
    return spring, jacobian, half @ half.T, dq


def expected(spring, jacobian, damping, dq, wrench):
    stray = 15.0 * 0.3 - 4.0 * dq
    null = np.eye(JOINTS) - jacobian.T @ np.linalg.pinv(jacobian.T)
    own = jacobian.T @ (wrench - damping @ jacobian @ dq)
    return own + null @ stray + np.array(spring.coriolis)


def test_torques_are_those_of_the_formula():
    moved, turned = [0.01, -0.02, 0.03], [1e-5, -2e-5, 3e-5]
    spring, *arm = impedance(turned, moved)
    spring.compute_torques()

    wrench = -STIFFNESS * [*moved, *turned]
    # The null space is kept off up to 1e-6 over the squared singular values.
    assert list(spring.torques) == pytest.approx(
        expected(spring, *arm, wrench), abs=1e-4
    )


def test_the_force_of_the_spring_is_bounded_and_keeps_its_direction():
    spring, *arm = impedance(moved=[0.3, 0.2, 0.0], largest=10.0)
    spring.compute_torques()

    force = -STIFFNESS[:3] * [0.3, 0.2, 0.0]
    wrench = [*(10.0 * force / np.linalg.norm(force)), 0.0, 0.0, 0.0]
    assert list(spring.torques) == pytest.approx(
        expected(spring, *arm, wrench), abs=1e-4
    )


@pytest.mark.parametrize("velocity", [-1.0, 0.0, 0.1, 2.0, -1e4])
def test_the_friction_is_that_of_the_formula(velocity):
    friction = Friction(
        doubles([velocity]), doubles([0.8]), doubles([9.0]), doubles([0.02])
    )
    friction.share = 0.5
    joint = JointImpedance(
        doubles([0.0]), doubles([velocity]), doubles([0.0]), np.inf, friction
    )
    joint.compute_torques()

    # 1 / (1 + e^-x) = (1 + tanh(x / 2)) / 2
    moving, resting = np.tanh(4.5 * (velocity + 0.02)), np.tanh(4.5 * 0.02)
    half = 0.5 * 0.8 * (moving - resting) / 2
    assert joint.torques[0] == pytest.approx(half, abs=1e-12)


@needs_both
@given(arrays(75), arrays(30), numbers)
def test_both_modes_agree_bit_for_bit(model, measured, largest):
    def scenario(module):
        q, dq, last = (doubles(measured[5 * k : 5 * k + 5]) for k in range(3))
        friction = module.Friction(dq, q, last, q)
        friction.share = 0.5
        spring = module.PoseImpedance(q, dq, last, largest, is_angle=True)
        spring.friction = friction
        spring.largest_force = spring.largest_torque = abs(largest)
        spring.start_at_rest(abs(model[0]))
        put(spring.pose, measured[14:])
        put(spring.jacobian, model[:30])
        put(spring.dampings, model[30:66])
        put(spring.wanted_axes, model[66:72])
        put(spring.posture, model[70:])
        joint = module.JointImpedance(q, dq, last, largest, friction)
        put(joint.target, model[:5])
        put(joint.wanted, model[5:10])
        put(joint.dampings, model[10:35])
        for law in (spring, spring, joint, joint):
            law.compute_torques()
        return [*spring.torques, *spring.axes, *joint.torques, *joint.desired]

    assert_same("impedances", scenario)
