"""Mass, Coriolis and gravity against published vectors, energy and symmetry."""

from math import pi

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import RobotDescriptionError
from station.core.franka.franka_model import Frame
from station.core.numerics.arm_dynamics import ArmDynamics
from station.hw.franka.arm.franka_kinematics import zero_jacobian
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics
from station.hw.urdf_loader import load_urdf

STRETCHED = [0.0] * 7
START = list(INITIAL_POSITIONS)
# Test configuration of franka_hw.
Q = [
    0.5157262388785411,
    1.2140897359597562,
    1.5346381355065786,
    -3.0398301021734246,
    -1.2930720893855998,
    1.332867311125138,
    -1.5554459725458225,
]
DQ = [0.3, -0.5, 0.7, 0.2, -0.9, 0.4, 1.1]
HAND = RigidBody(0.73, (-0.01, 0.0, 0.03), (0.001, 0, 0, 0, 0.0025, 0, 0, 0, 0.0017))


@pytest.fixture(scope="module")
def dynamics() -> FrankaDynamics:
    return FrankaDynamics(load_robot_files("example-robot-data:panda"))


# From the published identified inertias (Gaz et al.), printed to 5 digits.
@pytest.mark.parametrize(
    ("q", "load", "expected"),
    [
        (STRETCHED, RigidBody(), [0, -3.43443, 0, -3.25722, 0, 1.69422, 0]),
        (
            Q,
            RigidBody(),
            [0, -12.15617, 11.59729, 1.38335, 0.89492, 0.88627, -0.03472],
        ),
        (START, RigidBody(), [0, -1.77138, -0.64400, 18.57359, 0.63385, 1.69368, 0]),
        (START, HAND, [0, -3.91847, -0.67981, 21.90309, 0.68448, 2.27324, 0]),
    ],
)
def test_gravity_torques_equal_published_values(
    dynamics: FrankaDynamics, q: list[float], load: RigidBody, expected: list[float]
) -> None:
    assert dynamics.gravity(q, load) == pytest.approx(expected, abs=1e-5)


# What franka_hw's own test expects of the model that a real arm brings along.
@pytest.mark.parametrize(
    ("q", "expected", "tolerance"),
    [
        (STRETCHED, [0, -3.47218, 0, -3.20896, 0, 1.68623, 0], 0.05),
        (Q, [0, -12.1212, 11.5316, 1.35018, 0.973167, 0.918118, -0.0330053], 0.1),
    ],
)
def test_gravity_is_close_to_a_real_arms(
    dynamics: FrankaDynamics, q: list[float], expected: list[float], tolerance: float
) -> None:
    assert dynamics.gravity(q) == pytest.approx(expected, abs=tolerance)


def test_links_have_the_published_masses() -> None:
    links = load_urdf(load_robot_files("example-robot-data:panda")).links
    masses = [links[f"panda_link{number}"].inertial.mass for number in range(8)]
    assert sum(masses) == pytest.approx(16.692, abs=5e-4)


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        (RigidBody(), [0.46118, 1.44496, 0.87893, 0.78874, 0.02785, 0.03256, 0.00491]),
        (HAND, [0.52854, 1.55004, 0.98210, 0.95045, 0.04334, 0.05279, 0.00668]),
    ],
)
def test_mass_diagonal_equals_published_values(
    dynamics: FrankaDynamics, load: RigidBody, expected: list[float]
) -> None:
    mass = np.reshape(dynamics.mass(START, load), (7, 7))
    assert np.diag(mass) == pytest.approx(expected, abs=5.1e-6)


def test_mass_is_symmetric_and_positive(dynamics: FrankaDynamics) -> None:
    mass = np.reshape(dynamics.mass(Q, HAND), (7, 7))
    assert (mass == mass.T).all()
    assert np.linalg.eigvalsh(mass).min() > 0.0


def test_point_load_adds_its_mass_through_the_jacobian(
    dynamics: FrankaDynamics,
) -> None:
    point = RigidBody(2.0)
    jacobian = np.reshape(zero_jacobian(Frame.FLANGE, Q), (7, 6))[:, :3]
    added = np.subtract(dynamics.mass(Q, point), dynamics.mass(Q))
    # A point of 2 kg at the flange's origin.
    assert added == pytest.approx(2.0 * (jacobian @ jacobian.T).ravel(), abs=1e-12)
    weight = np.subtract(dynamics.gravity(Q, point), dynamics.gravity(Q))
    assert weight == pytest.approx(2.0 * 9.81 * jacobian[:, 2], abs=1e-12)


def test_coriolis_does_the_work_that_the_changing_mass_needs(
    dynamics: FrankaDynamics,
) -> None:
    step = 1e-6
    ahead = [q + step * dq for q, dq in zip(Q, DQ, strict=True)]
    behind = [q - step * dq for q, dq in zip(Q, DQ, strict=True)]
    change = np.subtract(dynamics.mass(ahead, HAND), dynamics.mass(behind, HAND))
    rate = np.reshape(change, (7, 7)) / (2.0 * step)
    power = np.dot(dynamics.coriolis(Q, DQ, HAND), DQ)
    # dM/dt - 2C is skew: dq C dq = dq dM/dt dq / 2.
    assert power == pytest.approx(0.5 * np.array(DQ) @ rate @ DQ, abs=1e-8)


def test_gravity_may_point_anywhere(dynamics: FrankaDynamics) -> None:
    tilted = dynamics.gravity(START, HAND, (3.0, -2.0, 4.0))
    parts = [
        dynamics.gravity(START, HAND, tuple(value if i == k else 0.0 for i in range(3)))
        for k, value in enumerate((3.0, -2.0, 4.0))
    ]
    assert tilted == pytest.approx(np.sum(parts, axis=0), abs=1e-12)


def test_load_can_be_changed_back(dynamics: FrankaDynamics) -> None:
    before = dynamics.mass(Q)
    dynamics.mass(Q, HAND)
    assert dynamics.mass(Q) == before


def test_names_of_the_arm_do_not_matter() -> None:
    description = load_robot_files("example-robot-data:panda")
    left = FrankaDynamics(description.with_prefix("panda_", "left_"))
    assert left.gravity([0.0, pi / 2, 0, 0, 0, 0, 0])[1] < -20.0


def test_other_robot_is_refused() -> None:
    with pytest.raises(RobotDescriptionError, match="no Franka arm"):
        FrankaDynamics(load_robot_files("example-robot-data:ur5"))


def test_what_is_asked_twice_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    dynamics = FrankaDynamics(load_robot_files("example-robot-data:panda"))
    weighed = []

    class Counted:
        """Counts what is asked of the compiled dynamics."""

        def __init__(self, computed: ArmDynamics) -> None:
            self._dynamics = computed

        def __getattr__(self, name: str) -> object:
            if name in {"mass", "coriolis", "gravity"}:
                weighed.append(name)
            return getattr(self._dynamics, name)

    monkeypatch.setattr(dynamics, "_dynamics", Counted(dynamics._dynamics))
    for load, dq in ((RigidBody(), DQ), (HAND, DQ), (HAND, DQ[::-1]), (HAND, DQ[::-1])):
        before = dynamics.mass(Q, load), dynamics.coriolis(Q, dq, load)
        weight = dynamics.gravity(Q, load)
        before[0][0] = 0.0  # the caller's own
        assert dynamics.coriolis(Q, dq, load) == before[1]
        assert dynamics.gravity(Q, load) == weight
        assert dynamics.mass(Q, load)[0] > 0.0
        fresh = FrankaDynamics(load_robot_files("example-robot-data:panda"))
        assert fresh.coriolis(Q, dq, load) == before[1]

    assert sorted(weighed) == [*["coriolis"] * 3, *["gravity"] * 2, *["mass"] * 2]
