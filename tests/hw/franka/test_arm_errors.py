"""Every error is raised by its cause, with its name, joint, value, limit and cycle."""

from math import pi

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ArmCommandError
from station.core.franka import FaultKind, RobotMode
from station.core.franka.franka_errors import error_names
from station.core.franka.franka_services import SimulatedFault
from station.core.geometry.scene import SceneObject
from station.hw.franka.arm.arm_limits import SupervisorLimits
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.arm_modes import LONGEST_SETTLING
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    simulate,
)
from station.hw.franka.simulated.simulated_arm import SimulatedArm

IMPEDANCE = ControllerMode.JOINT_IMPEDANCE
EXTERNAL = ControllerMode.EXTERNAL_CONTROLLER
NONE = MotionGeneratorMode.NONE
POSITION = MotionGeneratorMode.JOINT_POSITION
VELOCITY = MotionGeneratorMode.JOINT_VELOCITY
POSE = MotionGeneratorMode.CARTESIAN_POSITION
TWIST = MotionGeneratorMode.CARTESIAN_VELOCITY
ZEROS = [0.0] * 7
DESCRIPTION = load_robot_files("example-robot-data:panda")


@pytest.fixture
def arm() -> SimulatedArm:
    return simulate([ArmPlacement("panda", DESCRIPTION)]).arms["panda"]


def errors_of(arm: SimulatedArm) -> list[str]:
    return error_names(arm.state.current_errors)


def hold(arm: SimulatedArm, cycles: int = 5) -> list[float]:
    """Command what is there for some cycles; return it."""
    rest = list(arm.state.q_d)
    for _ in range(cycles):
        if arm.state.robot_mode is RobotMode.MOVE:
            arm.command_joint_positions(rest)
        arm.read_once()
    return rest


@pytest.mark.parametrize(
    ("jump", "names"),
    [
        (1e-6, []),
        (1e-5, ["acceleration_discontinuity"]),
        (1e-4, ["velocity_discontinuity", "acceleration_discontinuity"]),
        (
            5e-3,
            [
                "velocity_limits_violation",
                "velocity_discontinuity",
                "acceleration_discontinuity",
            ],
        ),
    ],
)
def test_position_jump_raises_the_errors_of_the_limits_it_exceeds(
    arm: SimulatedArm, jump: float, names: list[str]
) -> None:
    arm.start_motion(IMPEDANCE, POSITION)
    rest = hold(arm)
    rest[0] += jump
    arm.command_joint_positions(rest)
    arm.read_once()
    assert errors_of(arm) == [f"joint_motion_generator_{name}" for name in names]
    if names:
        assert arm.state.robot_mode is RobotMode.REFLEX
        worst = arm.errors()[0]
        assert worst.name == f"joint_motion_generator_{names[0]}"
        assert worst.where == "joint1"
        assert abs(worst.value) > worst.limit > 0.0
        assert worst.cycle == 6


def test_first_position_far_away_is_an_invalid_start(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, POSITION)
    arm.command_joint_positions([q + 0.02 for q in INITIAL_POSITIONS])
    arm.read_once()
    assert errors_of(arm) == ["joint_position_motion_generator_start_pose_invalid"]


def test_position_beyond_the_limit_is_named() -> None:
    start = (2.8973 - 1e-7, *INITIAL_POSITIONS[1:])
    placement = ArmPlacement("panda", DESCRIPTION, positions=start)
    arm = simulate([placement]).arms["panda"]
    arm.start_motion(IMPEDANCE, POSITION)
    rest = hold(arm)
    rest[0] += 4e-6
    arm.command_joint_positions(rest)
    arm.read_once()
    assert errors_of(arm) == ["joint_motion_generator_position_limits_violation"]
    assert arm.errors()[0].limit == 2.8973


def test_torque_step_is_a_discontinuity(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    for _ in range(5):
        arm.command_joint_torques(ZEROS)
        arm.read_once()
    arm.command_joint_torques([0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0])
    arm.read_once()
    assert errors_of(arm) == ["controller_torque_discontinuity"]
    error = arm.errors()[0]
    assert (error.where, error.value, error.limit) == ("joint4", 2000.0, 1000.0)
    assert "joint4: 2000 Nm/s, allowed is 1000 Nm/s (cycle 6)" in error.description


def test_fast_joint_is_a_velocity_violation(arm: SimulatedArm) -> None:
    arm.start_motion(EXTERNAL, NONE)
    for cycle in range(2_000):
        if arm.state.robot_mode is not RobotMode.MOVE:
            break
        arm.command_joint_torques([0.0] * 6 + [min(1.0, 0.01 * cycle)])
        arm.read_once()
    assert errors_of(arm) == ["joint_velocity_violation"]
    assert arm.errors()[0].value == pytest.approx(2.61, rel=0.1)


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ([0.002, 0.0, 0.0], "cartesian_motion_generator_velocity_limits_violation"),
        ([1e-4, 0.0, 0.0], "cartesian_motion_generator_velocity_discontinuity"),
        ([1e-5, 0.0, 0.0], "cartesian_motion_generator_acceleration_discontinuity"),
        ([0.1, 0.0, 0.0], "cartesian_position_motion_generator_start_pose_invalid"),
    ],
)
def test_pose_jump_raises_the_errors_of_the_limits_it_exceeds(
    arm: SimulatedArm, values: list[float], name: str
) -> None:
    arm.start_motion(IMPEDANCE, POSE)
    arm.refresh_state()
    pose = list(arm.state.O_T_EE_d)
    first = values[0] == 0.1
    for _ in range(0 if first else 5):
        arm.command_cartesian_pose(pose)
        arm.read_once()
    if values[0] == 0.002:
        values = [0.0025, 0.0, 0.0]
    moved = [p + v for p, v in zip(pose[12:15], values, strict=True)]
    arm.command_cartesian_pose([*pose[:12], *moved, 1.0])
    arm.read_once()
    assert errors_of(arm)[0] == name


def test_pose_that_is_no_transform_is_an_invalid_frame(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, POSE)
    arm.command_cartesian_pose([1.0] * 16)
    arm.read_once()
    assert errors_of(arm) == ["cartesian_position_motion_generator_invalid_frame"]


@pytest.mark.parametrize(
    ("elbow", "name"),
    [
        ([0.0, 1.0], "cartesian_motion_generator_elbow_sign_inconsistent"),
        ([0.1, -1.0], "cartesian_motion_generator_start_elbow_invalid"),
        ([0.005, -1.0], "cartesian_motion_generator_elbow_limit_violation"),
    ],
)
def test_impossible_elbow_is_named(
    arm: SimulatedArm, elbow: list[float], name: str
) -> None:
    arm.start_motion(IMPEDANCE, TWIST)
    arm.command_cartesian_velocity([0.0] * 6, elbow)
    arm.read_once()
    assert errors_of(arm) == [name]


def test_twist_into_a_joint_limit_is_named() -> None:
    start = (0.0, -pi / 4, 0.0, -3.0, 0.0, pi / 2, pi / 4)
    # Its hand comes close to its shoulder, too.
    close = SupervisorLimits(self_collision_distance=-1.0)
    placement = ArmPlacement("panda", DESCRIPTION, positions=start, thresholds=close)
    arm = simulate([placement]).arms["panda"]
    arm.start_motion(IMPEDANCE, TWIST)
    for cycle in range(3_000):
        if arm.state.robot_mode is not RobotMode.MOVE:
            break
        arm.command_cartesian_velocity([-min(0.1, 1e-4 * cycle * 0.1)] + [0.0] * 5)
        arm.read_once()
    assert "cartesian_motion_generator_joint_position_limits_violation" in errors_of(
        arm
    )


@pytest.mark.parametrize(("lost", "raised"), [(19, False), (20, True)])
def test_twenty_lost_packets_in_a_row_end_the_motion(
    arm: SimulatedArm, lost: int, *, raised: bool
) -> None:
    arm.start_motion(IMPEDANCE, POSITION)
    hold(arm, 200)
    arm.simulation().inject(SimulatedFault(FaultKind.LOST_PACKETS, lost))
    hold(arm, 25)
    assert ("communication_constraints_violation" in errors_of(arm)) is raised
    if not raised:
        assert arm.state.control_command_success_rate == pytest.approx(0.81)


def test_collision_ends_the_motion_and_the_log_tells_how(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, POSITION)
    hold(arm, 100)
    arm.simulation().inject(SimulatedFault(FaultKind.COLLISION, 100))
    for _ in range(50):
        if arm.state.robot_mode is RobotMode.MOVE:
            arm.command_joint_positions(list(INITIAL_POSITIONS))
        arm.read_once()
    assert "cartesian_reflex" in errors_of(arm)
    assert arm.state.last_motion_errors == arm.state.current_errors
    assert len(arm.log()) == 50
    times = [record.time for record in arm.log()]
    assert times == sorted(times)
    arm.automatic_error_recovery()
    assert errors_of(arm) == []
    assert "cartesian_reflex" in error_names(arm.state.last_motion_errors)
    assert arm.errors()


def test_motion_is_refused_until_recovery(arm: SimulatedArm) -> None:
    arm.simulation().inject(SimulatedFault(FaultKind.COLLISION, 50))
    for _ in range(200):
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.REFLEX
    with pytest.raises(ArmCommandError, match=r"mode reflex .*; remove the cause"):
        arm.start_motion(IMPEDANCE, POSITION)
    arm.automatic_error_recovery()
    for _ in range(LONGEST_SETTLING):
        arm.read_once()
    arm.start_motion(IMPEDANCE, POSITION)
    assert error_names(arm.state.last_motion_errors) == []


def test_user_stop_holds_the_arm_until_it_is_released(arm: SimulatedArm) -> None:
    arm.start_motion(IMPEDANCE, VELOCITY)
    for cycle in range(300):
        arm.command_joint_velocities([min(0.2, 0.001 * cycle)] * 7)
        arm.read_once()
    arm.simulation().set_user_stop(pressed=True)
    for _ in range(500):
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.USER_STOPPED
    assert max(map(abs, arm.state.dq)) < 1e-3
    with pytest.raises(ArmCommandError, match="user stop is pressed"):
        arm.automatic_error_recovery()
    with pytest.raises(ArmCommandError, match="release the user stop"):
        arm.start_motion(IMPEDANCE, POSITION)
    arm.simulation().set_user_stop(pressed=False)
    assert arm.state.robot_mode is RobotMode.IDLE


def test_stuck_joint_does_not_move_and_gets_free_again(arm: SimulatedArm) -> None:
    arm.simulation().inject(SimulatedFault(FaultKind.STUCK_JOINT, 100, joint=7))
    arm.start_motion(EXTERNAL, NONE)
    for cycle in range(100):
        arm.command_joint_torques([0.0] * 6 + [min(0.5, 0.01 * cycle)])
        arm.read_once()
    assert arm.state.q[6] == pytest.approx(INITIAL_POSITIONS[6], abs=1e-6)
    for _ in range(100):
        arm.command_joint_torques([0.0] * 6 + [0.5])
        arm.read_once()
    assert arm.state.q[6] > INITIAL_POSITIONS[6] + 1e-3


def test_blind_sensor_reads_no_number_and_the_arm_holds(arm: SimulatedArm) -> None:
    arm.simulation().inject(SimulatedFault(FaultKind.NAN_SENSOR, 20, joint=2))
    arm.read_once()
    assert arm.state.q[1] != arm.state.q[1]
    for _ in range(100):
        arm.read_once()
    assert arm.state.q == pytest.approx(INITIAL_POSITIONS, abs=1e-5)
    assert arm.state.robot_mode is RobotMode.IDLE


@pytest.mark.parametrize("times", [5, pytest.param(100, marks=pytest.mark.long)])
def test_table_stops_the_hand_at_once_every_time(times: int) -> None:
    # The tip of the hand starts at 0.487 m; the table's top is just below.
    table = SceneObject("table", "table", (0.6, 0.6, 0.1), (0.35, 0.0, 0.46))
    arm = simulate([ArmPlacement("panda", DESCRIPTION)], objects=[table]).arms["panda"]
    for _ in range(times):
        arm.start_motion(IMPEDANCE, TWIST)
        crossed = 0
        for cycle in range(3_000):
            arm.command_cartesian_velocity([
                0.0,
                0.0,
                -min(0.1, 3e-4 * cycle),
                *ZEROS[:3],
            ])
            arm.read_once()
            above = abs(arm.state.K_F_ext_hat_K[2]) > 20.0
            crossed = crossed or (cycle if above else 0)
            if arm.state.robot_mode is not RobotMode.MOVE:
                break
        assert "cartesian_reflex" in errors_of(arm)
        assert cycle - crossed <= 5
        for _ in range(100):
            arm.read_once()
        assert max(map(abs, arm.state.dq)) < 0.01
        arm.automatic_error_recovery()
        while arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            arm.read_once()
        assert arm.state.robot_mode is RobotMode.IDLE
        arm.start_motion(IMPEDANCE, TWIST)
        for cycle in range(300):  # away again
            speed = min(0.1, 3e-4 * cycle, 3e-4 * (299 - cycle))
            arm.command_cartesian_velocity([0.0, 0.0, speed, *ZEROS[:3]])
            arm.read_once()
        assert arm.state.robot_mode is RobotMode.MOVE, errors_of(arm)
        arm.stop_motion()
        for _ in range(50):
            arm.read_once()
