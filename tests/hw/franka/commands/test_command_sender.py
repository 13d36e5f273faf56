"""Commands reach the arm checked, limited and filtered, or the motion ends."""

from math import nan

import pytest

from station.core.franka import RobotMode
from station.core.franka.franka_robot_state import MODE
from station.core.hardware.limits import LimitMode
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_sender import CommandSender
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import CommandSettings, make_joint_rates
from station.memory.doubles import put
from tests.hw.franka.scripted_arm import ScriptedArm
from tests.hw.franka.test_franka_hw import JOINTS

PERIOD = 0.001
VELOCITIES = ControlMode.JOINT_VELOCITY, MotionGeneratorMode.JOINT_VELOCITY


class Limited:
    """A limit that halves commands and notes that it did."""

    def __init__(self, commands, done):
        self.commands = commands
        self.done = done

    def enforce_limits(self, period):
        self.done.append(f"limit {period:g}")
        put(self.commands, [value / 2.0 for value in self.commands])


class Bench:
    """A sender, what it sends from, and an arm that notes what it is sent."""

    def __init__(self, mode, generator, *, rate_limiting=False):
        self.arm, self.done = ScriptedArm(), []
        state = self.arm.state
        self.commands = JointCommands(state, JOINTS, LimitMode.ROS_CONTROL)
        memory = self.commands.memory
        cartesian = CartesianCommands(self.arm, "panda", PANDA_LIMITS, memory)
        self.handles = {
            interface.type_name: interface.get_handle("panda_robot")
            for interface in cartesian.interfaces()
        }
        self.rates = make_joint_rates(PANDA_LIMITS, state, self.commands)
        self.sender = CommandSender(
            self.arm,
            state.doubles(MODE),
            {1.0: "idle", 2.0: "move"},
            self.commands,
            cartesian,
            self.rates,
        )
        settings = CommandSettings(
            rate_limiting=rate_limiting,
            cutoff_frequency=1000.0,
            internal_controller=ControllerMode.JOINT_IMPEDANCE,
        )
        self.sender.begin_motion(mode, settings)
        self.arm.start_motion(ControllerMode.EXTERNAL_CONTROLLER, generator)

    def halve(self, commands):
        """Let limits halve some of the commands."""
        for limits in self.commands.limits():
            limits.enforced.singles = [Limited(commands, self.done)]


@pytest.fixture
def bench():
    return Bench(*VELOCITIES)


def test_a_command_is_limited_and_sent_once_per_cycle(bench):
    velocities = bench.commands.velocities
    put(velocities, [0.002] * 7)
    bench.halve(velocities)
    bench.sender.write(0.0, PERIOD)

    assert bench.done == ["limit 0.001"]
    assert bench.arm.sent == [[0.001] * 7]


def test_no_time_has_no_limits(bench):
    velocities = bench.commands.velocities
    put(velocities, [0.002] * 7)
    bench.halve(velocities)
    bench.sender.write(0.0, 0.0)

    assert bench.done == []
    assert bench.arm.sent == [[0.002] * 7]


def test_goals_are_noted_before_the_limits():
    mode, generator = ControlMode.JOINT_POSITION, MotionGeneratorMode.JOINT_POSITION
    bench = Bench(mode, generator, rate_limiting=True)
    positions = bench.commands.positions
    asked = [*positions]
    bench.halve(positions)
    bench.sender.write(0.0, PERIOD)

    assert [*bench.rates.goals] == asked
    assert [*positions] == [value / 2.0 for value in asked]


def test_torques_are_sent_before_the_pose_that_goes_with_them():
    mode = ControlMode.JOINT_TORQUE | ControlMode.CARTESIAN_POSE
    bench = Bench(mode, MotionGeneratorMode.CARTESIAN_POSITION)
    pose = [*bench.arm.state.O_T_EE_d]
    bench.handles["franka_hw::FrankaPoseCartesianInterface"].set_command(pose)
    put(bench.commands.efforts, [0.001] * 7)
    bench.sender.write(0.0, PERIOD)

    assert bench.arm.sent == [[0.001] * 7, pose]


def test_a_command_that_is_not_finite_ends_the_motion_unsent(bench):
    bench.commands.velocities[3] = nan
    bench.sender.write(0.0, PERIOD)

    assert bench.arm.sent == []
    assert bench.arm.state.robot_mode is RobotMode.IDLE
    assert bench.sender.refusal == "a command is not finite"
    bench.sender.write(0.0, PERIOD)
    assert bench.arm.sent == []


def test_a_refused_elbow_ends_the_motion_with_the_reason():
    mode, generator = ControlMode.CARTESIAN_POSE, MotionGeneratorMode.CARTESIAN_POSITION
    bench = Bench(mode, generator)
    handle = bench.handles["franka_hw::FrankaPoseCartesianInterface"]
    handle.set_command([*bench.arm.state.O_T_EE_d], [0.1, 0.5])
    bench.sender.write(0.0, PERIOD)

    assert bench.arm.state.robot_mode is RobotMode.IDLE
    assert bench.sender.refusal == "An elbow of [0.1, 0.5] is not possible"


@pytest.mark.parametrize(("rate_limiting", "count"), [(True, 2), (False, 1)])
def test_the_same_command_is_sent_again_only_with_rate_limits(rate_limiting, count):
    bench = Bench(*VELOCITIES, rate_limiting=rate_limiting)
    bench.sender.write(0.0, PERIOD)
    bench.sender.resend_commands()

    assert len(bench.arm.sent) == count
