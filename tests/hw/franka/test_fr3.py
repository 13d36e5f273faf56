"""The FR3: its masses, and its limits that depend on the position, as errors."""

from math import sqrt

import numpy as np
import pytest

from station.core.franka.franka_errors import ERROR_INDEX
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS, ArmLimits
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.franka.simulated.simulated_arm import SimulatedArm

PANDA = "example-robot-data:panda"
NEAR = (2.0, *INITIAL_POSITIONS[1:])
FOLDED = (*INITIAL_POSITIONS[:3], -2.0, *INITIAL_POSITIONS[4:])
IMPEDANCE = ControllerMode.JOINT_IMPEDANCE


def make(
    positions: tuple[float, ...] = INITIAL_POSITIONS, limits: ArmLimits = FR3_LIMITS
) -> SimulatedArm:
    description = load_arm_description(PANDA, limits)
    placement = ArmPlacement("arm", description, positions=positions, limits=limits)
    arm = simulate([placement]).arms["arm"]
    arm.read_once()
    return arm


def drive(arm: SimulatedArm, joint: int, velocity: float, cycles: int) -> None:
    """Command a velocity that grows by 4 rad/s^2, until the arm has an error."""
    arm.start_motion(IMPEDANCE, MotionGeneratorMode.JOINT_VELOCITY)
    rates = [0.0] * 7
    for cycle in range(cycles):
        rate = min(abs(velocity), 0.004 * cycle)
        rates[joint] = rate if velocity > 0.0 else -rate
        arm.command_joint_velocities(rates)
        arm.read_once()
        if arm.errors():
            return


def test_masses_are_those_of_the_fr3():
    # Pinocchio's numbers for libfranka@0.20.4 test/fr3.urdf, which has no hand.
    q, dq = (
        [0.4, -0.7, 0.3, -2.2, -0.5, 1.8, 0.9],
        [0.5, -1.0, 1.5, -0.7, 2.0, -1.2, 0.8],
    )
    gravity = [0.0, -2.8055452, -5.1754621, 18.4716091, 0.4712017, 1.3073689, -0.027576]
    coriolis = [
        -0.4478777, -0.7926061, -1.4526273, -2.0537631,
        -0.1402378, -0.3535856, 0.0087265,
    ]  # fmt: skip
    diagonal = [
        0.5679537, 1.6468927, 1.0671312, 0.8488884, 0.0239914, 0.0303874, 0.0001194,
    ]  # fmt: skip
    model = FrankaDynamics(load_arm_description(PANDA, FR3_LIMITS))
    assert model.gravity(q) == pytest.approx(gravity, abs=1e-7)
    assert model.coriolis(q, dq) == pytest.approx(coriolis, abs=1e-7)
    assert model.mass(q)[::8] == pytest.approx(diagonal, abs=1e-7)


def test_simulated_links_weigh_what_the_model_says():
    arm = make(NEAR)
    for _ in range(500):
        arm.read_once()
    state = arm.state
    model = arm.load_model()
    held = model.gravity(state.q, state.m_total, state.F_x_Ctotal)
    # The hand's fingers are a millimetre off, in a state that counts them as one body.
    assert state.tau_J == pytest.approx(held, abs=1e-3)
    assert state.tau_ext_hat_filtered == pytest.approx([0.0] * 7, abs=1e-3)


@pytest.mark.parametrize("joint", range(7))
def test_range_of_the_urdf_lies_within_the_limits(joint):
    urdf = FR3_LIMITS.urdf
    # franka_ros rounds the ends to 0.1 mrad; the limits fall by up to 5.1 1/s there.
    room = 0.5e-4 * 5.1
    for q in np.linspace(urdf.lower[joint], urdf.upper[joint], 200):
        low, high = FR3_LIMITS.velocity_range(joint, q)
        assert low - room <= -urdf.velocity[joint]
        assert high + room >= urdf.velocity[joint]


@pytest.mark.parametrize(
    ("joint", "velocity", "positions"), [(0, 1.5, NEAR), (3, -1.5, FOLDED)]
)
def test_commanded_velocity_near_a_limit_is_an_error_by_name(
    joint, velocity, positions
):
    arm = make(positions)
    drive(arm, joint, velocity, 2000)
    (error,) = arm.errors()
    assert error.name == "joint_motion_generator_velocity_limits_violation"
    assert error.where == f"joint{joint + 1}"
    assert error.value == pytest.approx(velocity, abs=1e-9)
    assert abs(error.limit) < abs(velocity)
    assert arm.state.current_errors[ERROR_INDEX[error.name]]
    # Where sqrt(2 d (end - q)) - o falls below it: o = 0.3 for both joints.
    end, slope = {0: (2.7501, 12.0), 3: (-3.0481, 8.0)}[joint]
    there = end - np.sign(velocity) * (abs(velocity) + 0.3) ** 2 / slope
    assert arm.state.q_d[joint] == pytest.approx(there, abs=0.01)

    panda = make(positions, PANDA_LIMITS)
    drive(panda, joint, velocity, 500)
    assert panda.errors() == []


def test_measured_velocity_near_a_limit_is_an_error_by_name_and_recovers():
    arm = make(NEAR)
    arm.start_motion(ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE)
    for cycle in range(1000):
        arm.command_joint_torques([min(3.0, 0.5 * cycle)] + [0.0] * 6)
        arm.read_once()
        if arm.errors():
            break
    (error,) = arm.errors()
    assert (error.name, error.where) == ("joint_velocity_violation", "joint1")
    bound = sqrt(12.0 * (2.7501 - arm.state.q[0])) - 0.3
    assert error.limit == pytest.approx(bound, abs=0.02)
    # 1 % of the largest limit is the room that every joint has for its noise.
    assert bound < error.value < 2.62
    for _ in range(500):
        arm.read_once()
    arm.automatic_error_recovery()
    for _ in range(500):
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.IDLE
    drive(arm, 0, -1.0, 300)
    assert arm.errors() == []
