"""The simulated arm holds, follows, changes modes without a jump, and tells torques."""

from itertools import product

import mujoco
import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Pose
from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    FrankaWorld,
    simulate,
)
from station.hw.franka.simulated.simulated_arm import SimulatedArm

IMPEDANCE = ControllerMode.JOINT_IMPEDANCE
EXTERNAL = ControllerMode.EXTERNAL_CONTROLLER
NONE = MotionGeneratorMode.NONE
POSITION = MotionGeneratorMode.JOINT_POSITION
VELOCITY = MotionGeneratorMode.JOINT_VELOCITY
ZEROS = [0.0] * 7
MODES = {
    "idle": None,
    "torque": (EXTERNAL, NONE),
    "position": (IMPEDANCE, POSITION),
    "velocity": (IMPEDANCE, VELOCITY),
    "torque_position": (EXTERNAL, POSITION),
    "torque_velocity": (EXTERNAL, VELOCITY),
}


@pytest.fixture
def simulation() -> FrankaWorld:
    description = load_robot_files("example-robot-data:panda")
    return simulate([ArmPlacement("panda", description)])


@pytest.fixture
def arm(simulation: FrankaWorld) -> SimulatedArm:
    return simulation.arms["panda"]


def enter(arm: SimulatedArm, mode: str) -> None:
    """Change to a mode and rest there, as a well-behaved client does."""
    arm.stop_motion()
    modes = MODES[mode]
    if modes is not None:
        arm.start_motion(*modes)


def command_rest(arm: SimulatedArm, mode: str, q: list[float]) -> None:
    controller, generator = MODES[mode] or (None, None)
    if controller is EXTERNAL:
        arm.command_joint_torques(ZEROS)
    if generator is POSITION:
        arm.command_joint_positions(q)
    if generator is VELOCITY:
        arm.command_joint_velocities(ZEROS)


def run(arm: SimulatedArm, cycles: int) -> None:
    for _ in range(cycles):
        arm.read_once()


def smooth(way: float) -> float:
    """Return a step from 0 to 1 whose jerk ends: a quintic."""
    x = max(0.0, min(1.0, way))
    return x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


def drive(arm: SimulatedArm, generator: str, goal: float, cycles: int) -> None:
    """Go to positions `goal` farther, or to velocities `goal`, within the limits."""
    start = list(arm.state.q_d)
    for cycle in range(cycles):
        share = goal * smooth((cycle + 1) / cycles)
        if generator == "position":
            arm.command_joint_positions([q + share for q in start])
        elif generator == "velocity":
            arm.command_joint_velocities([share] * 7)
        else:
            arm.command_joint_torques([share] * 4 + [share / 10.0] * 3)
        arm.read_once()


def test_idle_arm_holds_its_start_pose(arm: SimulatedArm) -> None:
    run(arm, 2_000)
    assert arm.state.robot_mode is RobotMode.IDLE
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-6)
    assert arm.state.tau_J_d == ZEROS
    assert arm.state.time == pytest.approx(2.0)


def test_measured_torque_at_rest_is_gravity(arm: SimulatedArm) -> None:
    run(arm, 100)
    # Start pose with hand; the weight of the fingers (2 * 15 g) and a slightly other
    # set of inertias in the URDF make the difference to the published vector.
    published = [0.0, -3.91847, -0.67981, 21.90309, 0.68448, 2.27324, 0.0]
    assert arm.state.tau_J == pytest.approx(published, abs=0.15)


def test_measured_torque_in_motion_is_that_of_inverse_dynamics(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    model = simulation.world.model
    arm.start_motion(IMPEDANCE, POSITION)
    inverse = mujoco.MjData(model)
    bare = np.array(model.dof_armature)
    for cycle in range(400):
        target = [q + 2e-6 * cycle * cycle for q in INITIAL_POSITIONS]
        arm.command_joint_positions(target)
        inverse.qpos[:] = simulation.world.data.qpos
        inverse.qvel[:] = simulation.world.data.qvel
        arm.read_once()
    inverse.qacc[:] = (simulation.world.data.qvel - inverse.qvel) / arm.cycle_time
    damping = np.array(model.dof_damping)
    model.dof_armature[:] = 0.0
    model.dof_damping[:] = 0.0
    mujoco.mj_inverse(model, inverse)
    link_side = inverse.qfrc_inverse[:7] + inverse.qfrc_gravcomp[:7]
    model.dof_armature[:] = bare
    model.dof_damping[:] = damping
    # Torques of some 20 Nm; rest is the fingers' constraint force.
    assert arm.state.tau_J == pytest.approx(link_side, abs=1e-3)


def test_memory_of_the_state_stays_the_same(arm: SimulatedArm) -> None:
    before = [id(arm.state.doubles(name)) for name in ("q", "dq", "tau_J", "q_d")]
    for mode in MODES:
        enter(arm, mode)
        run(arm, 3)
    after = [id(arm.state.doubles(name)) for name in ("q", "dq", "tau_J", "q_d")]
    assert after == before


def test_position_command_is_tracked(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, POSITION)
    drive(arm, "position", 0.3, 1_000)
    drive(arm, "position", 0.0, 500)
    expected = [q + 0.3 for q in INITIAL_POSITIONS]
    assert arm.state.q == pytest.approx(expected, abs=1e-5)
    assert arm.state.q_d == pytest.approx(expected, abs=1e-12)


def test_velocity_command_is_tracked_and_integrated(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, VELOCITY)
    drive(arm, "velocity", 0.2, 500)
    for _ in range(500):
        arm.command_joint_velocities([0.2] * 7)
        arm.read_once()
    assert arm.state.dq == pytest.approx([0.2] * 7, abs=0.005)
    # Half the way while it speeds up; the sum of 500 samples is 0.1 ms * 0.2 more.
    expected = [q + 0.15 for q in INITIAL_POSITIONS]
    assert arm.state.q_d == pytest.approx(expected, abs=2e-4)


def test_zero_torque_keeps_the_arm_where_it_is(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    drive(arm, "torque", 0.0, 2_000)
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-8)


def test_torque_accelerates_by_newtons_law(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    arm.start_motion(EXTERNAL, NONE)
    arm.command_joint_torques([0.0] * 6 + [0.1])
    run(arm, 10)
    mass = np.zeros((simulation.world.model.nv,) * 2)
    mujoco.mj_fullM(simulation.world.model, simulation.world.data, mass)
    torque = np.zeros(len(mass))
    torque[6] = 0.1
    acceleration = np.linalg.solve(mass, torque)
    # Joint damping 0.003 takes 0.03 % at this speed.
    assert arm.state.dq[6] == pytest.approx(0.01 * acceleration[6], rel=2e-3)
    assert arm.state.tau_J_d == [0.0] * 6 + [0.1]


def test_torque_saturates_at_the_effort_limit(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    for cycle in range(15):
        arm.command_joint_torques([0.0] * 6 + [-0.99 * cycle])
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.MOVE
    assert arm.state.tau_J_d == [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -12.0]


@pytest.mark.parametrize(("first", "second"), list(product(MODES, MODES)))
def test_mode_change_at_rest_does_not_move_the_arm(
    arm: SimulatedArm, first: str, second: str
) -> None:
    enter(arm, first)
    for _ in range(100):
        command_rest(arm, first, list(INITIAL_POSITIONS))
        arm.read_once()
    before = list(arm.state.q)
    enter(arm, second)
    seed = list(arm.state.q_d)
    for _ in range(100):
        command_rest(arm, second, seed)
        arm.read_once()
        assert arm.state.q == pytest.approx(before, abs=1e-3)


@pytest.mark.parametrize("second", MODES)
@pytest.mark.parametrize("first", ["position", "velocity", "torque"])
def test_mode_change_in_motion_brings_the_arm_to_rest(
    arm: SimulatedArm, first: str, second: str
) -> None:
    enter(arm, first)
    # A position motion is left half way, at its fastest.
    goal = {"position": 0.2, "velocity": 0.5, "torque": 2.0}[first]
    start = list(arm.state.q_d)
    for cycle in range(200):
        share = goal * smooth((cycle + 1) / 400 if first == "position" else cycle / 150)
        if first == "position":
            arm.command_joint_positions([value + share for value in start])
        elif first == "velocity":
            arm.command_joint_velocities([share] * 7)
        else:
            arm.command_joint_torques([share] * 4 + [share / 10.0] * 3)
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.MOVE
    before = list(arm.state.q)
    speed = max(abs(value) for value in arm.state.dq)
    enter(arm, second)
    run(arm, 300)  # it slows down by itself, and no command has come yet
    seed = list(arm.state.q_d)
    for _ in range(200):
        command_rest(arm, second, seed)
        arm.read_once()
    assert arm.state.robot_mode is (RobotMode.MOVE if MODES[second] else RobotMode.IDLE)
    assert max(abs(value) for value in arm.state.dq) < 1e-3
    # v^2 / 2a with the lowest deceleration, 7.5 rad/s^2, and some following error.
    moved = max(abs(a - b) for a, b in zip(arm.state.q, before, strict=True))
    assert moved < speed**2 / 15.0 + 0.02


def test_failing_torque_client_is_stopped_and_held(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    for cycle in range(50):
        arm.command_joint_torques([min(20.0, 0.9 * cycle), *ZEROS[1:]])
        arm.read_once()
    arm.stop_motion()
    run(arm, 500)
    held = list(arm.state.q)
    run(arm, 500)
    assert arm.state.q == pytest.approx(held, abs=1e-4)


def test_joint_impedance_sets_the_deflection_under_load(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    arm.set_joint_impedance([500.0] * 7)
    data = simulation.world.data
    data.qfrc_applied[:7] = [5.0] * 7
    run(arm, 2_000)
    moved = [a - b for a, b in zip(arm.state.q, INITIAL_POSITIONS, strict=True)]
    assert moved == pytest.approx([5.0 / 500.0] * 7, rel=1e-3)


def test_joint_impedance_is_refused_during_a_motion(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    with pytest.raises(ArmCommandError, match="while a motion runs"):
        arm.set_joint_impedance([100.0] * 7)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_command_that_is_not_finite_is_refused(arm: SimulatedArm, value: float) -> None:
    arm.start_motion(EXTERNAL, POSITION)
    with pytest.raises(InvalidCommandError, match="joint torques must be 7 finite"):
        arm.command_joint_torques([value, *ZEROS[1:]])
    with pytest.raises(InvalidCommandError, match="joint commands must be 7 finite"):
        arm.command_joint_positions([value, *ZEROS[1:]])


def test_command_that_fits_no_running_motion_is_refused(arm: SimulatedArm) -> None:
    with pytest.raises(ArmCommandError, match="mode IDLE, controller none"):
        arm.command_joint_torques(ZEROS)
    arm.start_motion(IMPEDANCE, VELOCITY)
    with pytest.raises(ArmCommandError, match="takes no joint positions"):
        arm.command_joint_positions(ZEROS)
    with pytest.raises(ArmCommandError, match="takes no Cartesian pose"):
        arm.command_cartesian_pose([0.0] * 16)
    with pytest.raises(ArmCommandError, match="takes no Cartesian velocity"):
        arm.command_cartesian_velocity([0.0] * 6)


@pytest.mark.parametrize(
    ("controller", "generator", "reason"),
    [
        (IMPEDANCE, NONE, "needs a motion generator"),
    ],
)
def test_impossible_modes_are_refused(
    arm: SimulatedArm,
    controller: ControllerMode,
    generator: MotionGeneratorMode,
    reason: str,
) -> None:
    with pytest.raises(ArmCommandError, match=reason):
        arm.start_motion(controller, generator)
    assert arm.state.robot_mode is RobotMode.IDLE


def test_second_motion_is_refused(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    with pytest.raises(ArmCommandError, match="a motion runs already"):
        arm.start_motion(IMPEDANCE, POSITION)


def test_reset_puts_the_arm_back_and_keeps_its_motion(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    arm.start_motion(IMPEDANCE, VELOCITY)
    drive(arm, "velocity", 0.3, 300)
    simulation.world.reset()
    run(arm, 100)
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-6)
    assert arm.state.robot_mode is RobotMode.MOVE
    assert arm.state.time == pytest.approx(0.4)


def test_diverged_simulation_ends_the_motion_until_it_is_reset(
    simulation: FrankaWorld, arm: SimulatedArm
) -> None:
    arm.start_motion(EXTERNAL, NONE)
    simulation.world.data.qvel[0] = float("nan")
    arm.read_once()
    assert arm.state.robot_mode is RobotMode.OTHER
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS)
    with pytest.raises(ArmCommandError, match="diverged"):
        arm.automatic_error_recovery()
    with pytest.raises(
        ArmCommandError, match="cannot start a motion: the simulation diverged"
    ):
        arm.start_motion(EXTERNAL, NONE)
    simulation.world.reset()
    arm.automatic_error_recovery()
    assert arm.state.robot_mode is RobotMode.IDLE


def test_two_arms_in_one_world_stay_in_lockstep() -> None:
    description = load_robot_files("example-robot-data:panda")
    simulation = simulate([
        ArmPlacement("left", description, Pose((0.0, 0.5, 0.0))),
        ArmPlacement("right", description, Pose((0.0, -0.5, 0.0))),
    ])
    left, right = simulation.arms["left"], simulation.arms["right"]
    left.start_motion(IMPEDANCE, VELOCITY)
    for cycle in range(100):
        left.command_joint_velocities([0.1 * smooth(cycle / 50)] * 7)
        left.read_once()
        right.read_once()
    assert simulation.world.step_count == 100
    assert left.state.time == right.state.time == pytest.approx(0.1)
    assert left.state.q_d[0] == pytest.approx(0.0075, abs=1e-4)
    assert right.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-6)


def test_fingers_are_held_open(simulation: FrankaWorld, arm: SimulatedArm) -> None:
    run(arm, 1_000)
    assert simulation.world.data.qpos[7:] == pytest.approx([0.04, 0.04], abs=1e-6)
    assert set(simulation.grippers) == {"panda"}
