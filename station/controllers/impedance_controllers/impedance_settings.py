"""Parameters that both impedance controllers have, and the design of their damping."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm.impedances import Friction
from station.core.control.tunables import Tunable
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_number,
    declare_numbers,
)
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, doubles

DESIGN_INTERVAL = 10
"""Cycles after which the damping is designed anew: the arm's inertia changes slowly."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter that gives the first value of a run-time parameter of its name."""

    name: str
    unit: str
    default: float
    maximum: float
    description: str

    def parameter(self) -> DeclaredParameter:
        """Return the parameter, which may be larger than a slider allows."""
        return declare_number(
            self.name, self.description, self.default, self.unit, minimum=0.0
        )

    def tunable(self, value: float) -> Tunable:
        """Return the run-time parameter; the range includes the configured value."""
        tunable = Tunable(self.unit, 0.0, self.maximum, self.description)
        return tunable.including(value)


DAMPING_RATIO = Setting(
    "damping_ratio", "", 1.0, 2.0, "damping; 1: no motion overshoots"
)
FRICTION_SHARE = Setting(
    "friction_compensation", "", 0.0, 1.0, "share of the friction that is compensated"
)


def _coefficients(
    name: str, unit: str, default: tuple[float, ...], text: str
) -> DeclaredParameter:
    return declare_numbers(name, text, default, unit, size=7, default_text="of a Panda")


FRICTION = (
    _coefficients(
        "friction/fp1",
        "Nm",
        (0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489),
        "friction of the joints at high speed, forwards plus backwards",
    ),
    _coefficients(
        "friction/fp2",
        "s/rad",
        (5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336),
        "how suddenly the friction rises with the speed",
    ),
    _coefficients(
        "friction/fp3",
        "rad/s",
        (0.03953, 0.02588, -0.04607, 0.03619, 0.02623, -0.02105, 0.00355),
        "velocity that makes the friction larger one way than the other",
    ),
)
"""The coefficients phi_1, phi_2 and phi_3 of Gaz et al., see `impedances`."""


def read_friction(params: Parameters, dq: Doubles) -> Friction:
    """Return the compensation of friction that the parameters describe, off at first.

    Args:
        params: The controller's namespace.
        dq: Measured joint velocities [rad/s], shape (7,).

    Raises:
        ParameterError: A coefficient is not a list of 7 numbers.
    """
    height, slope, shift = (doubles(each.read_float_list(params)) for each in FRICTION)
    return Friction(dq, height, slope, shift)


def read_settings(
    settings: Sequence[Setting], params: Parameters
) -> tuple[dict[str, Tunable], dict[str, float]]:
    """Return schema and values of run-time parameters, as the parameters have them.

    Raises:
        ParameterError: A parameter is not a number, or negative.
    """
    values = {each.name: each.parameter().read_float(params) for each in settings}
    return {each.name: each.tunable(values[each.name]) for each in settings}, values


def square(flat: Sequence[float]) -> NDArray[np.float64]:
    """Return a symmetric matrix of n n numbers, shape (n, n)."""
    size = round(len(flat) ** 0.5)
    return np.array(flat).reshape(size, size)


def damping_matrix(
    inertia: NDArray[np.floating], stiffness: Sequence[float], ratio: float
) -> NDArray[np.float64]:
    """Return the D of M ddx + D dx + K x = 0 whose motions all have one damping ratio.

    With M = L L^T and the eigenvalues w^2 of L^-1 K L^-T = V w^2 V^T it is
    D = 2 ratio L V w V^T L^T.

    Args:
        inertia: The matrix M, symmetric and positive definite, shape (n, n).
        stiffness: The diagonal of K, shape (n,), >= 0.
        ratio: The damping ratio, >= 0; 1 is critical damping.

    Returns:
        The matrix D, shape (n, n).

    Source:
        A. Albu-Schäffer, C. Ott, U. Frese, G. Hirzinger: Cartesian impedance control
        of redundant robots, ICRA 2003, the double diagonalization design.
    """
    lower = np.linalg.cholesky(inertia)
    inverse = np.linalg.inv(lower)
    squares, vectors = np.linalg.eigh((inverse * np.asarray(stiffness)) @ inverse.T)
    # Rounding makes the square of a frequency of 0 negative.
    frequencies = np.sqrt(np.maximum(squares, 0.0))
    shape = lower @ vectors
    damping: NDArray[np.float64] = (2.0 * ratio * shape * frequencies) @ shape.T
    return damping
