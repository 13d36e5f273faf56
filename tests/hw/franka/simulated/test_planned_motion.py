"""The simulated arm plans its way to positions that its client names now and then."""

from math import inf, nan

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate

POSITIONS = ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_POSITION
FASTEST = [0.6, 0.5, 0.7, 0.8, 1.0, 1.0, 1.5]
TARGET = [0.3, -0.6, 0.2, -2.0, 0.1, 1.8, 0.5]
LIMITS = {"panda": PANDA_LIMITS, "fr3": FR3_LIMITS}


def new_arm(kind):
    description = load_robot_files("example-robot-data:panda")
    placement = ArmPlacement("panda", description, limits=LIMITS[kind])
    return simulate([placement]).arms["panda"]


@pytest.fixture(params=LIMITS)
def arm(request):
    """An arm whose motion waits for a first target."""
    made = new_arm(request.param)
    made.read_once()
    made.start_motion(*POSITIONS)
    return made


def run(arm, cycles):
    """Let cycles pass without a command; return q_d of each, shape (cycles, 7)."""
    found = []
    for _ in range(cycles):
        arm.read_once()
        found.append(arm.state.q_d)
    return np.array(found)


def test_one_command_is_enough_for_the_whole_way(arm):
    run(arm, 50)
    assert arm.state.q_d == pytest.approx(INITIAL_POSITIONS, abs=1e-9)
    arm.plan_joint_positions(TARGET, FASTEST)
    path = run(arm, 2500)
    assert arm.state.robot_mode is RobotMode.MOVE
    assert arm.state.control_command_success_rate == 1.0
    assert arm.state.q_d == pytest.approx(TARGET, abs=1e-9)
    assert max(map(abs, arm.state.dq_d)) < 1e-6
    assert arm.state.q == pytest.approx(TARGET, abs=2e-3)
    velocities = np.abs(np.diff(path, axis=0)) / 1e-3
    assert (velocities <= np.array(FASTEST) + 1e-9).all()
    # All joints arrive together, and the slowest one goes as fast as it may.
    assert (velocities.max(axis=0) / FASTEST).max() == pytest.approx(1.0)


def test_newest_target_counts_wherever_the_arm_is(arm):
    arm.plan_joint_positions(TARGET, FASTEST)
    run(arm, 150)
    assert max(map(abs, arm.state.dq_d)) > 0.1
    other = [q - 0.2 for q in INITIAL_POSITIONS]
    for step in range(20):
        arm.plan_joint_positions([q + 1e-3 * step for q in other], FASTEST)
        run(arm, 7)
    arm.plan_joint_positions(other, FASTEST)
    run(arm, 2500)
    assert arm.state.robot_mode is RobotMode.MOVE
    assert arm.state.q_d == pytest.approx(other, abs=1e-9)


def test_more_than_the_arm_can_is_as_fast_as_the_arm_can(arm):
    """The checks of commanded positions hold for planned ones, too."""
    limits = LIMITS["fr3" if arm.limits is FR3_LIMITS else "panda"]
    arm.plan_joint_positions([-1.5, 1.0, 1.5, -1.0, -2.0, 3.0, -2.0], [100.0] * 7)
    path = run(arm, 4000)
    assert arm.errors() == []
    fastest = (np.abs(np.diff(path, axis=0)) / 1e-3).max(axis=0)
    assert (fastest <= np.array(limits.velocity) + 1e-9).all()
    assert fastest.max() > 2.0


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("joint", [0, 3, 4, 5, 6])
def test_velocity_limits_near_the_end_of_a_joint_bend_the_plan(joint, side):
    """Joints 5 and 7 may brake less hard than their velocity limit falls."""
    arm, q = new_arm("fr3"), list(INITIAL_POSITIONS)
    arm.read_once()
    arm.start_motion(*POSITIONS)
    bound = arm.limits.upper if side > 0 else arm.limits.lower
    q[joint] = bound[joint] - side * 0.02
    arm.plan_joint_positions(q, [100.0] * 7)
    run(arm, 3000)
    assert arm.errors() == []
    assert arm.state.q_d == pytest.approx(q, abs=1e-4)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("joint", range(7))
def test_target_beyond_a_limit_is_an_error_before_anything_moves(joint, side):
    arm = new_arm("fr3" if joint % 2 else "panda")
    arm.read_once()
    arm.start_motion(*POSITIONS)
    q = list(INITIAL_POSITIONS)
    q[joint] = (arm.limits.upper if side > 0 else arm.limits.lower)[joint] + 0.01 * side
    arm.plan_joint_positions(q, FASTEST)
    assert arm.state.robot_mode is RobotMode.REFLEX
    (error,) = arm.errors()
    assert error.name == "joint_motion_generator_position_limits_violation"
    run(arm, 100)
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-3)
    arm.automatic_error_recovery()
    run(arm, 1000)
    arm.start_motion(*POSITIONS)


def test_stop_on_the_way_slows_down_and_the_next_motion_begins_where_it_ends(arm):
    arm.plan_joint_positions(TARGET, FASTEST)
    run(arm, 200)
    arm.stop_motion()
    run(arm, 500)
    rest = arm.state.q_d
    assert not any(arm.state.dq_d)
    arm.start_motion(*POSITIONS)
    run(arm, 100)
    assert arm.state.q_d == pytest.approx(rest, abs=1e-12)
    arm.command_joint_positions(rest)
    run(arm, 25)  # a motion without a plan loses commands
    assert arm.errors()[0].name == "communication_constraints_violation"


@pytest.mark.parametrize("bad", [[nan] * 7, [inf] + [0.0] * 6, [0.0] * 6])
def test_what_is_no_target_is_refused(arm, bad):
    with pytest.raises(InvalidCommandError, match="7 finite numbers"):
        arm.plan_joint_positions(bad, FASTEST)


def test_only_a_motion_of_joint_positions_takes_targets(arm):
    arm.stop_motion()
    with pytest.raises(ArmCommandError, match="takes no joint positions"):
        arm.plan_joint_positions(TARGET, FASTEST)
