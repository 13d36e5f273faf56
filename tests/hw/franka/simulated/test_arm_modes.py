"""Every mode, and what leads from one to the next."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ArmCommandError
from station.core.franka import FaultKind, RobotMode
from station.core.franka.franka_errors import error_names
from station.core.franka.franka_services import SimulatedFault
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, SupervisorLimits
from station.hw.franka.arm.robot_arm import (
    REST_VELOCITY,
    ControllerMode,
    MotionGeneratorMode,
)
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.arm_modes import HALTED, LONGEST_SETTLING
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    simulate,
)
from station.hw.franka.simulated.realism import TYPICAL
from station.hw.franka.simulated.simulated_arm import SimulatedArm

DESCRIPTION = load_robot_files("example-robot-data:panda")
IMPEDANCE = ControllerMode.JOINT_IMPEDANCE
VELOCITY = MotionGeneratorMode.JOINT_VELOCITY
HIT = SimulatedFault(FaultKind.COLLISION, 30)
NONE = [0.0, 0.0, 0.0]


@pytest.fixture
def arm() -> SimulatedArm:
    return simulate([ArmPlacement("panda", DESCRIPTION)]).arms["panda"]


def run(arm: SimulatedArm, cycles: int) -> None:
    for _ in range(cycles):
        arm.read_once()


def move(arm: SimulatedArm, cycles: int = 300) -> None:
    """Turn all joints with up to 0.2 rad/s."""
    arm.start_motion(IMPEDANCE, VELOCITY)
    for cycle in range(cycles):
        arm.command_joint_velocities([min(0.2, 0.001 * cycle)] * 7)
        arm.read_once()


def hit(arm: SimulatedArm) -> None:
    arm.simulation().inject(HIT)
    run(arm, 30)
    assert arm.state.robot_mode is RobotMode.REFLEX


def test_recovery_during_the_motion_lasts_until_the_arm_is_at_rest(arm):
    move(arm)
    arm.simulation().inject(HIT)
    while arm.state.robot_mode is RobotMode.MOVE:
        arm.command_joint_velocities([0.2] * 7)
        arm.read_once()
    arm.simulation().clear_faults()
    run(arm, 5)
    modes = [arm.state.robot_mode]
    arm.automatic_error_recovery()
    for _ in range(1_000):
        modes.append(arm.state.robot_mode)
        arm.read_once()
    assert list(dict.fromkeys(modes)) == [
        RobotMode.REFLEX,
        RobotMode.AUTOMATIC_ERROR_RECOVERY,
        RobotMode.IDLE,
    ]
    assert error_names(arm.state.current_errors) == []


def test_motion_is_refused_while_the_arm_recovers(arm):
    move(arm)
    arm.simulation().set_user_stop(pressed=True)
    arm.simulation().set_user_stop(pressed=False)
    assert arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY
    with pytest.raises(ArmCommandError, match="wait until the arm is at rest"):
        arm.start_motion(IMPEDANCE, VELOCITY)
    run(arm, LONGEST_SETTLING)
    arm.start_motion(IMPEDANCE, VELOCITY)


def test_recovery_without_an_error_changes_nothing(arm):
    move(arm)
    arm.automatic_error_recovery()
    assert arm.state.robot_mode is RobotMode.MOVE
    hit_errors = error_names(arm.state.current_errors)
    assert hit_errors == []


def test_recovering_twice_is_recovering_once(arm):
    hit(arm)
    run(arm, LONGEST_SETTLING)
    arm.automatic_error_recovery()
    arm.automatic_error_recovery()
    assert arm.state.robot_mode is RobotMode.IDLE


def test_recovery_ends_when_the_arm_itself_is_at_rest(arm):
    hit(arm)
    arm.automatic_error_recovery()
    cycles = 0
    while arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
        arm.read_once()
        cycles += 1
    assert 10 < cycles < LONGEST_SETTLING
    assert arm.state.robot_mode is RobotMode.IDLE
    assert max(map(abs, arm.state.dtheta)) < REST_VELOCITY


def test_recovery_of_an_arm_that_trembles_ends_all_the_same(arm):
    hit(arm)
    arm.automatic_error_recovery()
    for cycle in range(LONGEST_SETTLING + 50):
        push = 5.0 if cycle % 20 < 10 else -5.0
        arm.simulation().apply_force("panda_link7", [0.0, 0.0, push], NONE, 0.001)
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.IDLE
    assert max(map(abs, arm.state.dtheta)) > REST_VELOCITY


@pytest.mark.parametrize("press_in", ["idle", "move", "reflex", "recovery", "guiding"])
def test_user_stop_can_be_pressed_in_every_mode(arm, press_in):
    if press_in in {"move", "recovery"}:
        move(arm)
    if press_in == "reflex":
        hit(arm)
    if press_in == "recovery":
        arm.simulation().set_user_stop(pressed=True)
        arm.simulation().set_user_stop(pressed=False)
        assert arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY
    if press_in == "guiding":
        arm.simulation().set_guiding(pressed=True)
    arm.simulation().set_user_stop(pressed=True)
    run(arm, 500)
    assert arm.state.robot_mode is RobotMode.USER_STOPPED
    assert max(map(abs, arm.state.dq)) < 1e-3
    with pytest.raises(ArmCommandError, match="user stop is pressed"):
        arm.automatic_error_recovery()
    arm.simulation().set_user_stop(pressed=True)  # twice is once
    arm.simulation().set_user_stop(pressed=False)
    assert arm.state.robot_mode is RobotMode.IDLE
    assert error_names(arm.state.current_errors) == []
    arm.simulation().set_user_stop(pressed=False)
    assert arm.state.robot_mode is RobotMode.IDLE


def test_arm_that_is_still_touched_goes_to_idle_and_holds(arm):
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -40.0], NONE, 20.0)
    run(arm, 500)
    assert arm.state.robot_mode is RobotMode.REFLEX
    for _ in range(3):
        arm.automatic_error_recovery()
        run(arm, 1_000)
        assert arm.state.robot_mode is RobotMode.IDLE
    arm.start_motion(IMPEDANCE, VELOCITY)
    for _ in range(500):
        arm.command_joint_velocities([0.0] * 7)
        arm.read_once()
    assert arm.state.robot_mode is RobotMode.MOVE


def test_touch_that_gets_much_harder_is_a_collision_again(arm):
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -40.0], NONE, 20.0)
    run(arm, 500)
    arm.automatic_error_recovery()
    run(arm, 100)
    arm.simulation().apply_force("panda_hand", [0.0, 0.0, -90.0], NONE, 20.0)
    run(arm, 100)
    assert "cartesian_reflex" in error_names(arm.state.current_errors)


def test_value_out_of_range_at_a_recovery_is_an_error_again_when_it_gets_worse():
    # The limits are 0.05 rad tighter here, so that no mechanical stop pushes back.
    outside = (2.87, *INITIAL_POSITIONS[1:])
    tight = SupervisorLimits(position_tolerance=-0.05)
    placement = ArmPlacement("panda", DESCRIPTION, positions=outside, thresholds=tight)
    arm = simulate([placement]).arms["panda"]
    run(arm, 20)
    assert error_names(arm.state.current_errors) == ["joint_position_limits_violation"]
    arm.automatic_error_recovery()
    run(arm, 20)
    assert arm.state.robot_mode is RobotMode.IDLE
    arm.start_motion(IMPEDANCE, VELOCITY)
    speeds = [-0.1] * 1_000 + [0.1] * 1_000
    speed = 0.0
    followed = 0
    for wanted in speeds:
        speed += max(-0.001, min(0.001, wanted - speed))
        arm.command_joint_velocities([speed, *[0.0] * 6])
        arm.read_once()
        if arm.state.robot_mode is not RobotMode.MOVE:
            break
        followed += 1
    assert followed > 1_100  # it was on its way out again
    assert arm.errors()[0].name == "joint_position_limits_violation"


def test_guided_arm_gives_way_and_holds_where_it_is_let_go(arm):
    arm.simulation().set_guiding(pressed=True)
    assert arm.state.robot_mode is RobotMode.GUIDING
    with pytest.raises(ArmCommandError, match="let go of the guiding buttons"):
        arm.start_motion(IMPEDANCE, VELOCITY)
    arm.simulation().apply_force("panda_hand", [0.0, 15.0, 0.0], NONE, 0.3)
    run(arm, 400)
    arm.refresh_state()
    assert arm.state.O_T_EE[13] > 0.02
    arm.simulation().set_guiding(pressed=False)
    run(arm, 500)
    held = list(arm.state.q)
    run(arm, 500)
    assert arm.state.robot_mode is RobotMode.IDLE
    assert arm.state.q == pytest.approx(held, abs=1e-3)


def test_moving_arm_cannot_be_guided(arm):
    move(arm)
    with pytest.raises(ArmCommandError, match="in mode move"):
        arm.simulation().set_guiding(pressed=True)


def test_every_mode_has_its_remedy_or_none(arm):
    for mode in RobotMode:
        arm.state.robot_mode = mode
        assert bool(arm.remedy()) is (mode in HALTED)


@pytest.mark.parametrize(("joint", "torque"), [(0, 15.0), (3, -15.0), (5, 6.0)])
def test_recovery_brings_a_joint_beyond_its_limit_inside(joint, torque):
    bound = (PANDA_LIMITS.upper if torque > 0.0 else PANDA_LIMITS.lower)[joint]
    begin = [*INITIAL_POSITIONS]
    begin[joint] = bound - 0.1 * (1.0 if torque > 0.0 else -1.0)
    placement = ArmPlacement("panda", DESCRIPTION, positions=tuple(begin))
    arm = simulate([placement]).arms["panda"]
    run(arm, 20)
    arm.start_motion(ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE)
    for cycle in range(1000):
        tau = [0.0] * 7
        tau[joint] = torque * min(1.0, cycle / 200)
        arm.command_joint_torques(tau)
        arm.read_once()
        if arm.state.robot_mode is RobotMode.REFLEX:
            break
    assert abs(arm.state.q[joint]) > abs(bound)

    arm.automatic_error_recovery()
    begun = arm.state.q[joint]
    fastest = 0.0
    while arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
        run(arm, 1)
        fastest = max(fastest, abs(arm.state.dq_d[joint]))

    assert arm.state.robot_mode is RobotMode.IDLE
    assert 0.003 < abs(bound) - abs(arm.state.q[joint]) < 0.007
    assert abs(begun - arm.state.q[joint]) < 0.02
    assert arm.state.ddq_d == [0.0] * 7


@pytest.mark.parametrize("force", [60.0, 100.0])
def test_recovery_in_the_middle_of_a_push_succeeds_at_once(force):
    placement = ArmPlacement("panda", DESCRIPTION, realism=TYPICAL)
    arm = simulate([placement]).arms["panda"]
    run(arm, 50)
    arm.simulation().apply_force("panda_hand", [0.0, force, 0.0], NONE, 0.2)
    while arm.state.robot_mode is not RobotMode.REFLEX:
        run(arm, 1)
    arm.automatic_error_recovery()
    while arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
        run(arm, 1)
    assert arm.state.robot_mode is RobotMode.IDLE
    run(arm, 500)
    assert arm.state.robot_mode is RobotMode.IDLE
