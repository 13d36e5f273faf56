"""The usual cycle of an arm: the same in both modes, and unusual ones left alone."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.core.franka import Frame
from station.hw.franka.arm.arm_codes import (
    CARTESIAN,
    CONTACT,
    GUIDING,
    IDLE,
    MOVE,
    NO_MOTION,
    POSITIONS,
    RECOVERY,
    UNUSUAL,
    VELOCITIES,
)
from station.hw.franka.arm.franka_kinematics import CHAIN, IDENTITY, frame_pose
from station.memory.doubles import Block, doubles, put, zeros
from tests.both_modes import (
    arrays,
    assert_same,
    interpreted,
    needs_both,
    sibling,
)

SIZE = 7
START = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
PERIOD = 0.001
QUANTITIES = (
    "positions",
    "dtheta",
    "tau_J",
    "q_d",
    "dq_d",
    "ddq_d",
    "tau_J_d",
    "target",
)
LOGGED = ("q", "dq", "tau_J", "dtau_J", "q_d", "dq_d", "ddq_d", "tau_J_d")
SIMULATED = ("positions", "velocities", "motor_forces", "bias", "compensation")


class Arm:
    """The parts of an arm's cycle, made of one mode's modules."""

    def __init__(self, module) -> None:
        def part(name):
            return sibling(module, name)

        states = Block(dict.fromkeys(LOGGED, SIZE))
        self.names = {name: states[name] for name in LOGGED}
        self.names |= {name: zeros(SIZE) for name in ("positions", "dtheta")}
        self.memory = part("joint_memory").JointMemory(SIZE, **self.names)
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
        self.mode = doubles([float(IDLE)])
        bounds = {"lower": [-2.8] * SIZE, "upper": [2.8] * SIZE}
        speeds = {"velocity": [2.0] * SIZE}
        self.motion = part("desired_motion").DesiredMotion(
            self.memory, **bounds, deceleration=[10.0] * SIZE, period=PERIOD
        )
        self.motors = part("joint_motors").JointMotors(self.memory, simulator, PERIOD)
        put(self.motors.stiffness, [600.0] * SIZE)
        put(self.motors.damping, [30.0] * SIZE)
        self.watch = part("joint_watch").JointWatch(
            self.memory,
            CHAIN,
            doubles(IDENTITY),
            **bounds,
            **speeds,
            torque=[87.0] * SIZE,
            reach=1.3,
            speed=50.0,
            power=1e4,
            deviation=(1.0, 1.0, 1.0),
            period=PERIOD,
        )
        self.watch.room = 1.0
        self.log = part("cycle_log").CycleLog(states.memory, SIZE)
        check = part("command_check").CommandCheck(
            self.memory,
            **bounds,
            **speeds,
            acceleration=[10.0] * SIZE,
            jerk=[5000.0] * SIZE,
            torque_rate=1000.0,
            period=PERIOD,
        )
        self.cartesian = self._cartesian_step(part, check)
        self.step = module.ArmStep(
            self.memory,
            self.mode,
            motion=self.motion,
            cartesian=self.cartesian,
            motors=self.motors,
            check=check,
            watch=self.watch,
            log=self.log,
            simulator=simulator,
        )

    def _cartesian_step(self, part, check):
        q_d, step = self.names["q_d"], zeros(SIZE)
        target, tool = zeros(16), doubles(IDENTITY)
        kinematics = part("inverse_kinematics").InverseKinematics(
            CHAIN, q_d, tool, target, step
        )
        sizes = {"pose": 16, "twist": 6, "acceleration": 6, "elbow": 2}
        sizes |= {"elbow_velocity": 2, "elbow_acceleration": 2}
        self.end_effector = {name: zeros(size) for name, size in sizes.items()}
        return part("cartesian_step").CartesianStep(
            self.memory,
            kinematics,
            check,
            **self.end_effector,
            translation=[2.0, 13.0, 6500.0],
            rotation=[2.5, 25.0, 12500.0],
            elbow_limits=[2.2, 10.0, 5000.0],
            period=PERIOD,
        )

    def set_mode(self, mode: int, generator: int = NO_MOTION) -> None:
        self.mode[0] = mode
        self.step.generator = generator

    def everything(self) -> list[float]:
        """Return all numbers that a cycle can change."""
        found = [*self.controls, self.watch.room, self.watch.total_power]
        for values in (*self.names.values(), *self.end_effector.values()):
            found += values
        for time, state, command in self.log.cycles():
            found += [time, *command, *(number for part in state for number in part)]
        return found


@pytest.fixture
def arm() -> Arm:
    return Arm(interpreted("arm_step"))


@pytest.mark.parametrize("mode", [GUIDING, RECOVERY])
def test_a_mode_that_is_not_usual_is_left_to_the_caller(arm, mode):
    arm.set_mode(mode)
    before = arm.everything()
    assert not arm.step.before()
    assert arm.everything() == before


@pytest.mark.parametrize(
    "flag", ["has_load", "has_faults", "is_cartesian", "wants_torques"]
)
def test_what_asks_for_more_is_left_to_the_caller(arm, flag):
    setattr(arm.step, flag, True)
    assert not arm.step.before()


def test_an_idle_arm_is_held_by_its_impedance(arm):
    put(arm.names["q_d"], [0.1] * SIZE)
    assert arm.step.before()
    assert list(arm.controls) == pytest.approx([60.0] * SIZE)


def test_a_command_is_followed_once_and_a_missing_one_is_left_to_the_caller(arm):
    arm.set_mode(MOVE, VELOCITIES)
    assert arm.step.before()  # nothing has arrived yet: the arm holds
    assert arm.step.receive(doubles([0.004] * SIZE), SIZE, arm.memory.target)
    assert arm.step.before()
    assert list(arm.names["dq_d"]) == [0.004] * SIZE
    assert arm.step.is_begun
    assert not arm.step.before()


def test_torques_reach_the_controls_within_the_limits(arm):
    arm.set_mode(MOVE)
    arm.step.wants_torques = arm.step.torques_act = True
    put(arm.names["tau_J_d"], [86.8] * SIZE)
    assert arm.step.receive(doubles([87.5] * SIZE), SIZE, arm.memory.torques)
    assert arm.step.before()
    assert list(arm.controls) == [87.0] * SIZE


def test_a_torque_step_is_left_to_the_caller_unchanged(arm):
    arm.set_mode(MOVE)
    arm.step.wants_torques = arm.step.torques_act = True
    arm.step.receive(doubles([1.1] * SIZE), SIZE, arm.memory.torques)
    before = arm.everything()
    assert not arm.step.before()
    assert arm.everything() == before
    assert arm.step.is_fresh


@pytest.mark.parametrize(
    "command", [[float("nan")] * SIZE, [0.0] * 6, [float("inf")] * 7]
)
def test_a_command_that_is_not_seven_finite_numbers_is_not_taken(arm, command):
    assert not arm.step.receive(doubles(command), SIZE, arm.memory.target)
    assert not arm.step.is_fresh


@pytest.mark.parametrize("generator", [POSITIONS, CARTESIAN])
def test_a_first_position_and_a_first_pose_are_left_to_the_caller(arm, generator):
    arm.set_mode(MOVE, generator)
    arm.step.receive(doubles([0.0] * SIZE), SIZE, arm.memory.target)
    assert not arm.step.before()


def test_a_slow_twist_moves_the_joints(arm):
    put(arm.names["q_d"], START)
    put(arm.end_effector["pose"], frame_pose(Frame.END_EFFECTOR, START))
    arm.set_mode(MOVE, CARTESIAN)
    arm.step.is_begun = True
    assert arm.step.receive_end_effector(doubles([1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]), 6)
    assert arm.step.before()
    reached = frame_pose(Frame.END_EFFECTOR, [*arm.names["q_d"]])
    assert reached == pytest.approx([*arm.end_effector["pose"]], abs=1e-12)
    assert arm.names["dq_d"][1] != 0.0


def test_a_fast_twist_is_left_to_the_caller_unchanged(arm):
    put(arm.names["q_d"], START)
    put(arm.end_effector["pose"], frame_pose(Frame.END_EFFECTOR, START))
    arm.set_mode(MOVE, CARTESIAN)
    arm.step.is_begun = True
    arm.step.receive_end_effector(doubles([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]), 6)
    before = arm.everything()
    assert not arm.step.before()
    assert arm.everything() == before
    assert arm.step.is_fresh


def test_a_contact_and_a_reading_out_of_range_are_told(arm):
    assert arm.step.after(0.001) == 0
    arm.constraints[3] = 1.0
    assert arm.step.after(0.002) == CONTACT
    arm.simulated["positions"][0] = 3.0
    assert arm.step.after(0.003) == CONTACT + UNUSUAL


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    mode=st.sampled_from([IDLE, MOVE]),
    generator=st.sampled_from([NO_MOTION, POSITIONS, VELOCITIES]),
    has_torques=st.booleans(),
    begun=st.booleans(),
    memory=st.lists(arrays(SIZE), min_size=8, max_size=8),
    simulated=st.lists(arrays(SIZE), min_size=5, max_size=5),
    commands=st.lists(arrays(SIZE), min_size=1, max_size=3),
)
def test_both_modes_give_the_same_bits(
    mode, generator, has_torques, begun, memory, simulated, commands
):
    def scenario(module):
        arm = Arm(module)
        arm.set_mode(mode, generator)
        arm.step.wants_torques = arm.step.torques_act = has_torques
        arm.step.is_begun = begun
        for name, values in zip(QUANTITIES, memory, strict=True):
            if name in arm.names:
                put(arm.names[name], values)
        for name, values in zip(SIMULATED, simulated, strict=True):
            put(arm.simulated[name], values)
        found = []
        for number, command in enumerate(commands):
            if has_torques:
                found.append(
                    arm.step.receive(doubles(command), SIZE, arm.memory.torques)
                )
            found.append(arm.step.receive(doubles(command), SIZE, arm.memory.target))
            found.append(arm.step.before())
            found.append(arm.step.after(0.001 * number))
            arm.motion.extrapolate()
        return [*found, *arm.everything()]

    assert_same("arm_step", scenario)
