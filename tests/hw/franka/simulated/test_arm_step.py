"""The cycle of an arm: commands are followed once each, and missed ones made up for."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from hypothesis import given, settings, strategies as st

from station.core.errors import InvalidCommandError
from station.core.franka import Frame, RobotMode, RobotState
from station.hw.franka.arm.arm_limits import (
    PANDA_LIMITS,
    MotionLimits,
    SupervisorLimits,
)
from station.hw.franka.arm.franka_kinematics import CHAIN, frame_pose
from station.hw.franka.arm.receiver import (
    CARTESIAN,
    IDLE,
    MOVE,
    NO_MOTION,
    POSITIONS,
    VELOCITIES,
)
from station.hw.franka.simulated.arm_step import CONTACT, VIOLATION
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import (
    arrays,
    assert_same,
    compiled,
    interpreted,
    needs_both,
    sibling,
)

SIZE = 7
START = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
PERIOD = 0.001
FIELDS = ("q", "dq", "theta", "dtheta", "tau_J", "q_d", "dq_d", "ddq_d", "tau_J_d")
QUANTITIES = ("theta", "dtheta", "tau_J", "q_d", "dq_d", "ddq_d", "tau_J_d")
END_EFFECTOR = ("O_T_EE_c", "O_dP_EE_c", "O_ddP_EE_c", "elbow_c", "delbow_c")
SIMULATED = ("positions", "velocities", "motor_forces", "bias", "compensation")
LIMITS = replace(
    PANDA_LIMITS,
    lower=(-2.8,) * SIZE,
    upper=(2.8,) * SIZE,
    velocity=(2.0,) * SIZE,
    acceleration=(10.0,) * SIZE,
    jerk=(5000.0,) * SIZE,
    translation=MotionLimits(2.0, 13.0, 6500.0),
)


class Faults:
    """Loses the commands of some cycles."""

    def __init__(self) -> None:
        self.act = True
        self.lost = False

    def loses_packet(self) -> bool:
        return self.lost

    def count_step(self) -> None:
        """No joint is stuck."""

    def disturb(self, state: RobotState) -> None:
        """No sensor is blind."""

    def finish_cycle(self) -> None:
        """No command was dropped."""


class Arm:
    """The parts of an arm's cycle, made of one mode's modules.

    Attributes:
        calls: What was left to parts that are not here.
        errors: What the motion was ended by.
    """

    def __init__(self, module) -> None:
        def part(name):
            return sibling(module, name)

        self.state = state = RobotState(control_command_success_rate=1.0)
        self.names = {name: state.doubles(name) for name in FIELDS}
        given = {name: state.doubles(name) for name in FIELDS if name != "theta"}
        self.memory = part("joint_memory").JointMemory(
            SIZE, positions=state.doubles("theta"), **given
        )
        self.simulated = {name: zeros(SIZE) for name in SIMULATED}
        self.controls, self.constraints = zeros(SIZE), zeros(SIZE)
        simulator = part("simulator_memory").SimulatorMemory(
            SIZE,
            **self.simulated,
            controls=self.controls,
            constraint_forces=self.constraints,
            limits=doubles([87.0] * SIZE),
            inertia=doubles([0.5] * SIZE),
        )
        self.motion = part("desired_motion").DesiredMotion(
            self.memory,
            lower=LIMITS.lower,
            upper=LIMITS.upper,
            deceleration=LIMITS.acceleration,
            period=PERIOD,
        )
        self.motors = part("joint_motors").JointMotors(self.memory, simulator, PERIOD)
        self.motors.engage([600.0] * SIZE, [30.0] * SIZE)
        tool = state.doubles("F_T_EE")
        thresholds = SupervisorLimits(0.0, 1.0, power=1e4)
        self.watch = part("joint_watch").JointWatch(
            self.memory, CHAIN, tool, LIMITS, thresholds, PERIOD, has_hand=False
        )
        self.watch.room = 1.0
        self.log = module.CycleLog(state.motion(), SIZE)
        check = part("motion_check").MotionCheck(self.memory, LIMITS, PERIOD)
        self.cartesian = part("cartesian_step").CartesianStep(
            self.memory, check, state.doubles, CHAIN, PERIOD
        )
        self.calls: list[str] = []
        self.errors: list[object] = []
        self.faults = Faults()
        self.step = module.ArmStep(
            self.memory,
            state,
            motion=self.motion,
            cartesian=self.cartesian,
            motors=self.motors,
            actuators=SimpleNamespace(
                engage_torques=lambda: self.calls.append("torques act"),
                apply_torques=self.give_torques,
                apply_cartesian_impedance=lambda: self.calls.append("impedance"),
                carry=lambda _: self.calls.append("load"),
            ),
            load=SimpleNamespace(weight=lambda q: [*q]),
            faults=self.faults,
            check=check,
            watch=self.watch,
            log=self.log,
            world=part("world_step").WorldStep(None, (0, 0, 0), None, None, None),
        )
        self.step.modes = SimpleNamespace(
            raise_errors=self.errors.extend,
            advance_recovery=lambda: self.calls.append("recovery"),
            is_still=lambda: True,
        )
        self.set_mode(IDLE)

    def set_mode(self, mode: int, generator: int = NO_MOTION) -> None:
        self.state.robot_mode = RobotMode(mode)
        self.step.begin_motion(generator)

    def give_torques(self, torques: list[float]) -> None:
        put(self.memory.torques, torques)
        self.motors.apply_torques()

    def send(self, values: list[float], *, is_lost: bool = False) -> None:
        """Send a command for the joints, and advance by a cycle."""
        self.step.command_joints(values)
        self.step.has_faults = self.faults.lost = is_lost
        self.step.prepare_step()

    def let_torques_act(self) -> None:
        self.step.wants_torques = self.motors.torques_act = True

    def begin_at(self, q: list[float]) -> None:
        """Begin a Cartesian motion at some positions, after its first command."""
        put(self.names["q_d"], q)
        self.set_mode(MOVE, CARTESIAN)
        pose = self.state.doubles("O_T_EE_c")
        assert self.step.receive_end_effector(pose, 16)
        self.step.prepare_step()
        assert self.errors == []

    def everything(self) -> list[float]:
        """Return all numbers that a cycle can change."""
        found = [*self.controls, self.watch.room, *self.memory.target]
        for name in (*FIELDS, *END_EFFECTOR):
            found += self.state.doubles(name)
        for time, state, command in self.log.cycles():
            found += [time, *command, *(number for part in state for number in part)]
        return found


@pytest.fixture
def arm() -> Arm:
    return Arm(interpreted("arm_step"))


@pytest.fixture
def moving() -> Arm:
    """An arm whose velocities are commanded, as the process runs it."""
    arm = Arm(compiled("arm_step"))
    put(arm.names["q_d"], START)
    arm.set_mode(MOVE, VELOCITIES)
    return arm


@pytest.mark.parametrize(
    ("flag", "call"), [("has_load", "load"), ("wants_torques", "torques act")]
)
def test_what_is_rare_is_left_to_other_parts(arm, flag, call):
    setattr(arm.step, flag, True)
    arm.step.prepare_step()
    assert arm.calls == [call]


def test_an_arm_that_recovers_is_moved_by_its_modes(arm):
    arm.state.robot_mode = RobotMode.AUTOMATIC_ERROR_RECOVERY
    arm.step.prepare_step()
    assert arm.calls == ["recovery"]


def test_a_guided_arm_is_damped_where_it_is(arm):
    arm.state.robot_mode = RobotMode.GUIDING
    put(arm.names["theta"], START)
    put(arm.names["dtheta"], [0.1] * SIZE)
    arm.step.prepare_step()
    assert list(arm.controls) == pytest.approx([-1.0] * 4 + [-0.1] * 3)
    assert list(arm.names["q_d"]) == START


def test_an_idle_arm_is_held_by_its_impedance(arm):
    put(arm.names["q_d"], [0.1] * SIZE)
    arm.step.prepare_step()
    assert list(arm.controls) == pytest.approx([60.0] * SIZE)


def test_nothing_happens_before_the_first_command(moving):
    for _ in range(100):
        moving.step.prepare_step()
    assert not moving.step.is_begun
    assert list(moving.names["q_d"]) == START
    assert moving.state.control_command_success_rate == 1.0


def test_missed_command_keeps_the_acceleration(moving):
    for cycle in range(1, 4):
        moving.send([0.003 * cycle] * SIZE)
    moving.send([0.0] * SIZE, is_lost=True)
    assert moving.errors == []
    assert moving.state.dq_d == pytest.approx([0.012] * SIZE)
    assert moving.state.control_command_success_rate == pytest.approx(0.99)


def test_twenty_commands_lost_in_a_row_end_the_motion(moving):
    moving.send([0.0] * SIZE)
    for _ in range(19):
        moving.step.prepare_step()
    assert moving.errors == []
    moving.step.prepare_step()
    (error,) = moving.errors
    assert (error.name, error.value) == ("communication_constraints_violation", 20.0)


def test_losses_are_forgotten_after_a_hundred_cycles(moving):
    for cycle in range(150):
        moving.send([0.0] * SIZE, is_lost=cycle in {10, 20})
    assert moving.state.control_command_success_rate == 1.0


def test_lost_torques_repeat_the_last_ones(moving):
    moving.set_mode(MOVE)
    moving.let_torques_act()
    moving.step.command_torques([0.5] * SIZE)
    moving.step.prepare_step()
    moving.step.command_torques([0.9] * SIZE)
    moving.step.has_faults = moving.faults.lost = True
    moving.step.prepare_step()
    assert list(moving.memory.torques) == [0.5] * SIZE


def test_malformed_commands_are_refused(moving):
    step = moving.step
    for values in ([0.0] * 6, [float("nan")] * SIZE, [float("inf")] * SIZE):
        with pytest.raises(InvalidCommandError, match="7 finite"):
            step.command_joints(values)
    with pytest.raises(InvalidCommandError, match="16 finite"):
        step.command_cartesian([0.0] * 6, None, 16)
    with pytest.raises(InvalidCommandError, match="elbow"):
        step.command_cartesian([0.0] * 6, [0.1, 0.5], 6)
    assert not step.is_fresh


def test_torques_reach_the_controls_within_the_limits(arm):
    arm.set_mode(MOVE)
    arm.let_torques_act()
    put(arm.names["tau_J_d"], [86.8] * SIZE)
    assert arm.step.receive(doubles([87.5] * SIZE), SIZE, arm.memory.torques)
    arm.step.prepare_step()
    assert list(arm.controls) == [87.0] * SIZE
    assert arm.errors == []


def test_a_torque_step_ends_the_motion(arm):
    arm.set_mode(MOVE)
    arm.let_torques_act()
    arm.step.receive(doubles([1.1] * SIZE), SIZE, arm.memory.torques)
    arm.step.prepare_step()
    assert {error.name for error in arm.errors} == {"controller_torque_discontinuity"}
    assert arm.log.cycles() == []


def test_a_first_position_far_away_ends_the_motion(arm):
    arm.set_mode(MOVE, POSITIONS)
    arm.send([0.02] * SIZE)
    name = "joint_position_motion_generator_start_pose_invalid"
    assert [error.name for error in arm.errors] == [name] * SIZE
    assert list(arm.names["q_d"]) == [0.0] * SIZE


def test_a_first_pose_far_away_ends_the_motion(arm):
    put(arm.names["q_d"], START)
    arm.set_mode(MOVE, CARTESIAN)
    pose = frame_pose(Frame.END_EFFECTOR, START)
    pose[12] += 0.006
    arm.step.command_cartesian(pose, None, 16)
    arm.step.prepare_step()
    name = "cartesian_position_motion_generator_start_pose_invalid"
    assert [(error.name, error.where) for error in arm.errors] == [
        (name, "translation")
    ]


def test_a_slow_twist_moves_the_joints(arm):
    arm.begin_at(START)
    assert arm.step.receive_end_effector(doubles([1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]), 6)
    arm.step.prepare_step()
    reached = frame_pose(Frame.END_EFFECTOR, [*arm.names["q_d"]])
    assert reached == pytest.approx([*arm.state.O_T_EE_c], abs=1e-9)
    assert arm.names["dq_d"][1] != 0.0


def test_a_fast_twist_ends_the_motion_where_it_is(arm):
    arm.begin_at(START)
    arm.step.receive_end_effector(doubles([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]), 6)
    arm.step.prepare_step()
    rates = ("velocity_discontinuity", "acceleration_discontinuity")
    names = [f"cartesian_motion_generator_{rate}" for rate in rates]
    assert [error.name for error in arm.errors] == names
    assert list(arm.names["q_d"]) == pytest.approx(START, abs=1e-9)


def test_a_contact_and_a_reading_out_of_range_are_told(arm):
    assert arm.step.read_joints() == 0
    arm.constraints[3] = 1.0
    assert arm.step.read_joints() == CONTACT
    arm.simulated["positions"][0] = 3.0
    assert arm.step.read_joints() == CONTACT + VIOLATION


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    mode=st.sampled_from([IDLE, MOVE]),
    generator=st.sampled_from([NO_MOTION, POSITIONS, VELOCITIES, CARTESIAN]),
    has_torques=st.booleans(),
    memory=st.lists(arrays(SIZE), min_size=7, max_size=7),
    simulated=st.lists(arrays(SIZE), min_size=5, max_size=5),
    commands=st.lists(arrays(SIZE), min_size=1, max_size=3),
)
def test_both_modes_give_the_same_bits(
    mode, generator, has_torques, memory, simulated, commands
):
    def scenario(module):
        arm = Arm(module)
        for name, values in zip(QUANTITIES, memory, strict=True):
            put(arm.names[name], values)
        for name, values in zip(SIMULATED, simulated, strict=True):
            put(arm.simulated[name], values)
        arm.set_mode(mode, generator)
        if has_torques:
            arm.let_torques_act()
        found = []
        for command in commands:
            if has_torques:
                arm.step.receive(doubles(command), SIZE, arm.memory.torques)
            if generator == CARTESIAN:
                arm.step.receive_end_effector(doubles(command[:6]), 6)
            else:
                arm.step.receive(doubles(command), SIZE, arm.memory.target)
            arm.step.prepare_step()
            found += [arm.step.is_begun, arm.step.read_joints()]
            for error in arm.errors:
                found += [error.value, error.limit]
        return [*found, *arm.everything()]

    assert_same("arm_step", scenario)
