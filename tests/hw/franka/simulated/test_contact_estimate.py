"""External torques and wrench: right in sign and size, zero when nothing touches."""

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Pose
from station.core.franka import RobotMode
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.self_collision import clearance
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    FrankaWorld,
    simulate,
)
from station.hw.franka.simulated.simulated_arm import SimulatedArm

NONE = [0.0, 0.0, 0.0]


@pytest.fixture(scope="module")
def simulation() -> FrankaWorld:
    # High above the floor, so that no pose touches it.
    placement = ArmPlacement(
        "panda",
        load_robot_files("example-robot-data:panda"),
        Pose((0.0, 0.0, 2.0)),
    )
    return simulate([placement])


@pytest.fixture
def arm(simulation: FrankaWorld) -> SimulatedArm:
    arm = simulation.arms["panda"]
    arm.set_load(RigidBody())
    put(simulation, INITIAL_POSITIONS)
    return arm


def put(simulation: FrankaWorld, q: tuple[float, ...]) -> None:
    """Put the arm somewhere, at rest and without errors."""
    names = [f"panda_joint{number}" for number in range(1, 8)]
    simulation.world.reset(dict(zip(names, q, strict=True)))
    simulation.arms["panda"].automatic_error_recovery()


def run(arm: SimulatedArm, cycles: int) -> None:
    for _ in range(cycles):
        arm.read_once()


def poses(count: int, reach: float) -> list[tuple[float, ...]]:
    """Return random poses around the start pose, away from singular ones."""
    generator = np.random.default_rng(7)
    spread = generator.uniform(-reach, reach, (count, 7))
    return [tuple(row) for row in (np.array(INITIAL_POSITIONS) + spread).tolist()]


@pytest.mark.parametrize("q", poses(10, 0.4))
def test_push_of_the_hand_is_measured_with_opposite_sign(
    simulation: FrankaWorld, arm: SimulatedArm, q: tuple[float, ...]
) -> None:
    put(simulation, q)
    force = [6.0, -9.0, 12.0]
    arm.simulation().apply_force("panda_hand", force, NONE, 1.0)
    run(arm, 500)
    # What is left is how the arm still creeps towards its deflected pose.
    assert arm.state.O_F_ext_hat_K[:3] == pytest.approx(
        [-value for value in force], abs=0.02 * np.linalg.norm(force)
    )
    arm.refresh_state()
    rotation = np.reshape(arm.state.O_T_EE, (4, 4))[:3, :3]  # rows: axes of K in O
    local = rotation @ arm.state.O_F_ext_hat_K[:3]
    assert arm.state.K_F_ext_hat_K[:3] == pytest.approx(local, abs=1e-9)


def test_nothing_is_measured_at_rest_in_any_pose(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    low, high = np.array(arm.limits.lower) + 0.1, np.array(arm.limits.upper) - 0.1
    generator = np.random.default_rng(11)
    tested = 0
    while tested < 100:
        q = tuple(generator.uniform(low, high).tolist())
        if clearance(q, has_hand=True) < 0.03:
            continue  # an arm does not stay there
        put(simulation, q)
        if simulation.world.data.ncon:
            continue  # the floor is in the way
        tested += 1
        run(arm, 10)
        assert arm.state.tau_ext_hat_filtered == pytest.approx([0.0] * 7, abs=1e-6)
        assert arm.state.O_F_ext_hat_K == pytest.approx([0.0] * 6, abs=1e-5)
        assert not any(arm.state.joint_collision)
        assert arm.state.robot_mode is RobotMode.IDLE


def test_estimate_agrees_with_torque_sensor_and_model(arm: SimulatedArm) -> None:
    run(arm, 10)
    rest = list(arm.state.tau_J)
    arm.simulation().apply_force("panda_link4", [0.0, 15.0, 0.0], NONE, 5.0)
    run(arm, 3_000)
    felt = [now - then for now, then in zip(arm.state.tau_J, rest, strict=True)]
    # The arm yields by a mrad or so, which moves its weight a little.
    assert arm.state.tau_ext_hat_filtered == pytest.approx(felt, abs=0.05)
    assert max(map(abs, felt)) > 2.5


def test_load_that_is_not_there_shows(arm: SimulatedArm) -> None:
    arm.set_load(RigidBody(1.0))
    run(arm, 1_000)
    # The arm believes to carry 1 kg: what is missing pulls the hand upwards.
    assert arm.state.O_F_ext_hat_K[2] == pytest.approx(-9.81, rel=0.02)
    assert max(map(abs, arm.state.O_F_ext_hat_K[:2])) < 0.1


def test_load_that_is_held_does_not_show(arm: SimulatedArm) -> None:
    # At the hand's centre of mass, where the push acts.
    arm.set_load(RigidBody(1.0, (-0.01 * 0.5**0.5, -0.01 * -(0.5**0.5), 0.03)))
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -9.81], NONE, 5.0)
    run(arm, 2_000)
    assert arm.state.O_F_ext_hat_K[:3] == pytest.approx(NONE, abs=0.1)
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-4)


def test_contact_clears_itself_and_collision_stays(arm: SimulatedArm) -> None:
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -40.0], NONE, 0.05)
    run(arm, 30)
    assert arm.state.robot_mode is RobotMode.REFLEX
    assert arm.state.cartesian_contact[2] == arm.state.cartesian_collision[2] == 1.0
    run(arm, 300)
    assert not any(arm.state.cartesian_contact)
    assert arm.state.cartesian_collision[2] == 1.0
    arm.automatic_error_recovery()
    assert not any(arm.state.cartesian_collision)
    assert arm.state.robot_mode is RobotMode.IDLE


def test_recovery_in_contact_is_no_new_collision(arm: SimulatedArm) -> None:
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -40.0], NONE, 10.0)
    run(arm, 100)
    arm.automatic_error_recovery()
    run(arm, 500)
    assert arm.state.robot_mode is RobotMode.IDLE
    assert arm.state.cartesian_contact[2] == 1.0
    arm.simulation().apply_force("panda_hand", NONE, NONE, 0.1)
    run(arm, 200)
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -40.0], NONE, 1.0)
    run(arm, 50)
    assert arm.state.robot_mode is RobotMode.REFLEX


def test_second_blow_while_the_arm_recovers_does_not_undo_the_recovery(
    arm: SimulatedArm,
) -> None:
    push = arm.simulation().apply_force
    push("panda_hand", [0.0, 0.0, -40.0], NONE, 0.05)
    run(arm, 30)
    assert arm.state.robot_mode is RobotMode.REFLEX
    push("panda_hand", [200.0, 0.0, 0.0], NONE, 0.02)
    run(arm, 2)
    arm.automatic_error_recovery()
    assert arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY
    run(arm, 1_000)
    assert arm.state.robot_mode is RobotMode.IDLE


def test_wrench_is_zero_in_a_singular_pose(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    put(simulation, (0.0, 0.0, 0.0, -0.08, 0.0, 0.6, 0.0))
    arm.simulation().apply_force("panda_hand", [0.0, 8.0, 0.0], NONE, 1.0)
    run(arm, 50)
    assert arm.state.O_F_ext_hat_K == [0.0] * 6
    assert max(map(abs, arm.state.tau_ext_hat_filtered)) > 1.0
