"""An arm that was lost is connected to again, without a new start."""

import pytest

from station.core.errors import ArmCommandError
from station.core.franka import RobotMode
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.fci.driver.arm_link import Reconnection
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.fci_client import Connection
from station.hw.franka.fci.driver.network import SLICE, UDP_TIMEOUT, FciNetworkError
from station.hw.franka.fci.wire.robot_protocol import PANDA, Command
from tests.hw.franka.fci.driver.test_driver import answering
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.plain_model import PlainModel
from tests.hw.franka.scripted_arm import ScriptedArm

MOTION = ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_POSITION
LONGEST = 100_000
"""Looks within which the other thread has made its connection."""


class Robot:
    """An arm that can be connected to several times, and its driver."""

    def __init__(self):
        self.is_absent = False
        self.networks = []
        self.behind = ScriptedArm()
        self.arm = FciArm(self.open(), PlainModel, is_enforced=False, reopen=self.open)

    def open(self):
        if self.is_absent:
            raise FciNetworkError("libfranka: Connection timeout at h:1337.")
        self.networks.append(SteppedNetwork(self.behind))
        return self.networks[-1]

    def lose(self):
        """Let the arm be silent until it is lost."""
        self.networks[-1].is_silent = True
        for _ in range(round(UDP_TIMEOUT / SLICE)):
            self.arm.wait()
        assert self.arm.is_lost()

    def await_recovery(self):
        """Wait as the control thread does, until the attempt is over."""
        for _ in range(LONGEST):
            self.arm.wait()
            if self.arm.state.robot_mode is not RobotMode.AUTOMATIC_ERROR_RECOVERY:
                return self.arm.state.robot_mode
        raise AssertionError("the attempt does not end")


@pytest.fixture
def robot():
    made = Robot()
    yield made
    made.arm.close()


def test_recovery_of_a_lost_arm_connects_again(robot):
    arm = robot.arm
    arm.start_motion(*MOTION)
    robot.lose()
    assert robot.networks[0].is_closed
    assert arm.remedy().startswith("restore the connection, then recover")
    arm.check_recovery()
    arm.automatic_error_recovery()
    assert arm.state.robot_mode is RobotMode.AUTOMATIC_ERROR_RECOVERY

    assert robot.await_recovery() is RobotMode.IDLE
    assert not arm.is_lost()
    assert (arm.failure(), arm.remedy(), arm.errors()) == ("", None, [])
    before = arm.state.time
    assert arm.wait() == 1
    assert arm.read_once().time == pytest.approx(before + arm.cycle_time)
    arm.start_motion(*MOTION)
    assert arm.state.robot_mode is RobotMode.MOVE


def test_collision_behavior_is_set_again(robot):
    robot.arm.set_collision_behavior(DEFAULT_COLLISION_BEHAVIOR)
    robot.behind.behavior = None
    robot.lose()
    robot.arm.automatic_error_recovery()
    assert robot.await_recovery() is RobotMode.IDLE
    assert robot.behind.behavior == DEFAULT_COLLISION_BEHAVIOR


def test_arm_that_does_not_answer_stays_lost_and_says_why(robot):
    robot.lose()
    robot.is_absent = True
    robot.arm.automatic_error_recovery()
    assert robot.await_recovery() is RobotMode.OTHER
    assert robot.arm.failure() == "libfranka: Connection timeout at h:1337."
    with pytest.raises(ArmCommandError, match="Connection timeout at h:1337"):
        robot.arm.start_motion(*MOTION)
    robot.is_absent = False
    robot.arm.automatic_error_recovery()
    assert robot.await_recovery() is RobotMode.IDLE


def test_arm_that_counts_its_states_anew_is_no_jump_of_time(robot):
    robot.networks[0].messages = 1_000_000
    robot.arm.wait()
    robot.lose()
    robot.arm.automatic_error_recovery()
    assert robot.await_recovery() is RobotMode.IDLE
    assert robot.arm.wait() == 1
    assert robot.arm.read_once().time < 1.0


def test_second_recovery_waits_for_the_first(robot):
    robot.lose()
    for _ in range(3):
        robot.arm.automatic_error_recovery()
    robot.await_recovery()
    assert len(robot.networks) == 2


def test_arm_that_refuses_its_settings_is_hung_up_on(monkeypatch):
    opened = SteppedNetwork(ScriptedArm())
    answering(monkeypatch, opened, Command.SET_COLLISION_BEHAVIOR, 2)
    reconnection = Reconnection(lambda: opened, PANDA)
    reconnection.ask([(Command.SET_COLLISION_BEHAVIOR, {})])
    reconnection.close()
    assert reconnection.take_connection() == (
        "libfranka: Set Collision Behavior command rejected: invalid argument!"
    )
    assert opened.is_closed


def test_connection_that_nobody_takes_is_hung_up():
    opened = SteppedNetwork(ScriptedArm())
    reconnection = Reconnection(lambda: opened, PANDA)
    reconnection.ask([])
    reconnection.close()
    assert isinstance(reconnection.take_connection(), Connection)
    assert opened.is_closed
