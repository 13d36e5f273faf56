"""Dynamics of chains against pinocchio, and both modes."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings, strategies as st

from station.core.numerics import arm_dynamics
from station.core.numerics.arm_chain import new_links
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both
from tests.core.numerics.test_arm_chain import chain_of, truth_of

PARAMETERS = [
    (0.0, 0.3, 0.0),
    (0.1, 0.0, -1.5),
    (0.0, 0.2, 1.5),
    (0.2, 0.1, 0.4),
    (0.0, 0.1, 0.0),
]
SIZE = len(PARAMETERS) - 1
rates = st.lists(st.floats(-3.0, 3.0), min_size=SIZE, max_size=SIZE)


def inertias():
    rng = np.random.default_rng(7)
    return [
        pin.Inertia(mass, rng.normal(size=3) / 10.0, np.diag([0.01, 0.02, 0.025]))
        for mass in rng.uniform(0.5, 4.0, size=SIZE)
    ]


def moments_of(inertia):
    """Return mass, first and second moments about the origin, 10 numbers."""
    about = inertia.inertia - inertia.mass * pin.skew(inertia.lever) @ pin.skew(
        inertia.lever
    )
    second = np.trace(about) / 2.0 * np.eye(3) - about
    return [
        inertia.mass,
        *(inertia.mass * inertia.lever).tolist(),
        *np.diag(second).tolist(),
        *second[np.triu_indices(3, 1)].tolist(),
    ]


BODIES = [value for inertia in inertias() for value in moments_of(inertia)]


def dynamics_of(module, chain, bodies):
    chain = doubles(chain)
    return module.ArmDynamics(chain, doubles(bodies), new_links(chain))


def evaluate(dynamics, q, dq, acceleration):
    """Return mass matrix, Coriolis and gravity torques."""
    size = len(q)
    mass, coriolis, gravity = zeros(size * size), zeros(size), zeros(size)
    dynamics.move_to(q)
    dynamics.mass(mass)
    dynamics.coriolis(doubles(dq), coriolis)
    dynamics.gravity(doubles(acceleration), gravity)
    return mass, coriolis, gravity


@settings(max_examples=50)
@given(rates, rates)
def test_mass_coriolis_and_gravity_are_those_of_pinocchio(q, dq):
    model = truth_of(PARAMETERS)
    for joint, inertia in enumerate(inertias(), 1):
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    model.gravity.linear = np.array([1.0, -2.0, -9.0])
    data, q_, dq_ = model.createData(), np.array(q), np.array(dq)
    dynamics = dynamics_of(arm_dynamics, chain_of(PARAMETERS), BODIES)
    mass, coriolis, gravity = evaluate(dynamics, q, dq, [1.0, -2.0, -9.0])

    weight = pin.computeGeneralizedGravity(model, data, q_).copy()
    forces = pin.rnea(model, data, q_, dq_, np.zeros(SIZE)) - weight
    inertia = pin.crba(model, data, q_)
    inertia = np.triu(inertia) + np.triu(inertia, 1).T
    assert np.reshape(mass, (SIZE, SIZE)) == pytest.approx(inertia, abs=1e-12)
    assert np.array(coriolis) == pytest.approx(forces, abs=1e-11)
    assert np.array(gravity) == pytest.approx(weight, abs=1e-11)


def test_positions_may_be_any_sequence():
    results = []
    for kind in (list, tuple, doubles, np.array):
        dynamics = dynamics_of(arm_dynamics, chain_of(PARAMETERS), BODIES)
        evaluate(dynamics, [1.0, 0.0, 0.0, 0.0], [0.0] * 4, [0.0] * 3)
        parts = evaluate(dynamics, kind([0.1, 0.2, 0.3, 0.4]), [0.5] * 4, [1.0] * 3)
        results.append([part.tolist() for part in parts])

    assert results == [results[0]] * 4


def test_new_bodies_count_once_they_are_announced():
    bodies = doubles(BODIES)
    chain = chain_of(PARAMETERS)
    dynamics = arm_dynamics.ArmDynamics(chain, bodies, new_links(chain))
    _, _, before = evaluate(dynamics, [0.5] * 4, [0.0] * 4, [0.0, 9.81, 0.0])
    bodies[:] = doubles([2.0 * value for value in BODIES])
    dynamics.change_bodies()
    _, _, after = evaluate(dynamics, [0.5] * 4, [0.0] * 4, [0.0, 9.81, 0.0])

    assert after.tolist() == pytest.approx([2.0 * value for value in before])


@needs_both
@settings(max_examples=60)
@given(arrays(32), arrays(70), arrays(7), arrays(7), arrays(3))
def test_both_modes_agree_bit_for_bit(chain, bodies, q, dq, acceleration):
    def scenario(module):
        dynamics = dynamics_of(module, chain, bodies)
        parts = evaluate(dynamics, q, dq, acceleration)
        return [value for part in parts for value in part]

    assert_same("arm_dynamics", scenario)
