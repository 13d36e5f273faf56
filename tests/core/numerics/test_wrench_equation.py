"""Solutions against NumPy, and both modes."""

import numpy as np
import pytest
from hypothesis import given

from station.core.numerics.arm_chain import WrenchEquation
from station.memory.doubles import doubles, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers


@pytest.mark.parametrize("joints", [6, 7, 9])
@pytest.mark.parametrize("damping", [0.0, 1e-9, 0.04])
def test_the_equation_is_solved(joints, damping):
    rng = np.random.default_rng(joints)
    matrix, b, x = rng.normal(size=(6, joints)), rng.normal(size=6), zeros(6)
    equation = WrenchEquation()

    assert equation.factorise(doubles(matrix.T.ravel()), damping)
    equation.solve(doubles(b), x)
    wanted = np.linalg.solve(matrix @ matrix.T + damping * np.eye(6), b)
    assert x.tolist() == pytest.approx(wanted.tolist(), rel=1e-9)


def test_negative_damping_compares_the_smallest_singular_value():
    matrix = np.random.default_rng(5).normal(size=(6, 7))
    least = np.linalg.svd(matrix, compute_uv=False)[-1]
    jacobian, equation = doubles(matrix.T.ravel()), WrenchEquation()

    assert equation.factorise(jacobian, -((0.999 * least) ** 2))
    assert not equation.factorise(jacobian, -((1.001 * least) ** 2))


def test_a_singular_jacobian_is_not_factorised():
    equation = WrenchEquation()

    assert not equation.factorise(zeros(42), 0.0)
    assert not equation.factorise(doubles([float("nan")] * 42), 1.0)
    assert equation.factorise(zeros(42), 1.0)


@needs_both
@given(arrays(42), numbers, arrays(6))
def test_both_modes_agree_bit_for_bit(jacobian, damping, b):
    def scenario(module):
        equation, x = module.WrenchEquation(), zeros(6)
        is_definite = equation.factorise(doubles(jacobian), damping)
        equation.solve(doubles(b), x)
        return [float(is_definite), *x]

    assert_same("arm_chain", scenario)
