"""What the driver does when the arm refuses, errs, or is gone."""

import threading
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import pytest

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import RobotMode
from station.core.franka.franka_errors import error_names
from station.hw.franka.arm.robot_arm import (
    MOST_LOST_PACKETS,
    ControllerMode,
    MotionGeneratorMode,
)
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.fci_client import IncompatibleVersionError
from station.hw.franka.fci.driver.network import SLICE, UDP_TIMEOUT, FciNetworkError
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    PANDA,
    Command,
    Status,
)
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.plain_model import PlainModel
from tests.hw.franka.scripted_arm import ScriptedArm

JOINT, EXTERNAL = ControllerMode.JOINT_IMPEDANCE, ControllerMode.EXTERNAL_CONTROLLER
POSITION = MotionGeneratorMode.JOINT_POSITION


@pytest.fixture
def network():
    return SteppedNetwork(ScriptedArm())


@pytest.fixture
def arm(network):
    return FciArm(network, PlainModel, is_enforced=False)


def answering(monkeypatch, network, command, status):
    """Let the robot answer one command with a status, whatever it thinks."""
    serve = network.session.receive

    def receive(data):
        head = HEADER.unpack(data[: HEADER.size])
        if head["command"] != command:
            return serve(data)
        exchange = PANDA.exchanges[command]
        known = isinstance(status, Status)
        number = exchange.statuses.index(status) if known else status
        body = exchange.response.pack({"status": number})
        return HEADER.pack({**head, "size": HEADER.size + len(body)}) + body

    monkeypatch.setattr(network.session, "receive", receive)


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (
            Status.COMMAND_NOT_POSSIBLE_REJECTED,
            r'Move command rejected: command not possible in the current mode \("Idle"',
        ),
        (Status.START_AT_SINGULAR_POSE_REJECTED, "cannot start at singular pose!"),
        (Status.INVALID_ARGUMENT_REJECTED, "maximum path deviation out of range!"),
        (Status.EMERGENCY_ABORTED, "Move command aborted: User Stop pressed!"),
        (77, "Unexpected response while handling Move command!"),
    ],
)
def test_refused_motion_is_told_in_libfrankas_words(
    monkeypatch, network, arm, status, words
):
    answering(monkeypatch, network, Command.MOVE, status)
    with pytest.raises(ArmCommandError, match=words) as refused:
        arm.start_motion(JOINT, POSITION)
    assert refused.value.remedy
    assert arm.state.robot_mode is RobotMode.IDLE


@pytest.mark.parametrize(
    ("status", "error", "words"),
    [
        (
            Status.INVALID_ARGUMENT_REJECTED,
            InvalidCommandError,
            "Set Joint Impedance command rejected: invalid argument!",
        ),
        (
            Status.COMMAND_NOT_POSSIBLE_REJECTED,
            ArmCommandError,
            "Set Joint Impedance command rejected: command not possible",
        ),
    ],
)
def test_refused_setting_is_told_in_libfrankas_words(
    monkeypatch, network, arm, status, error, words
):
    answering(monkeypatch, network, Command.SET_JOINT_IMPEDANCE, status)
    with pytest.raises(error, match=words):
        arm.set_joint_impedance([100.0] * 7)


def test_command_has_libfrankas_name(monkeypatch, network, arm):
    answering(monkeypatch, network, Command.SET_NE_TO_EE, 1)
    with pytest.raises(ArmCommandError, match="libfranka: Set NE to EE command rejec"):
        arm.set_end_effector_frame(arm.state.NE_T_EE)


def test_other_version_is_refused_with_both_numbers():
    class Older(SteppedNetwork):
        def send(self, data):
            changed = bytearray(data)
            changed[HEADER.size] = 4
            super().send(bytes(changed))

    older = Older(ScriptedArm())
    with pytest.raises(IncompatibleVersionError, match=r"server version: 5, library v"):
        FciArm(older, PlainModel)
    assert older.is_closed


def test_motion_needs_a_realtime_thread_unless_told_otherwise(network):
    def find(_thread):
        return "libfranka: unable to set realtime scheduling"

    arm = FciArm(network, PlainModel, find_problem=find)
    with pytest.raises(ArmCommandError, match="unable to set realtime"):
        arm.start_motion(JOINT, POSITION)
    assert arm.read_once().robot_mode is RobotMode.IDLE


def test_thread_that_reads_is_the_one_that_has_to_be_realtime(network):
    asked = []
    arm = FciArm(network, PlainModel, find_problem=asked.append)
    with ThreadPoolExecutor(1) as control:
        control.submit(arm.read_once).result()
        reader = control.submit(threading.get_native_id).result()
    assert arm.refusal(JOINT, POSITION) is None
    assert asked == [reader]


def test_torques_and_motion_leave_together_and_once_per_state(network, arm):
    arm.start_motion(EXTERNAL, POSITION)
    arm.command_joint_torques([0.5] * 7)
    assert network.datagrams == []
    arm.command_joint_positions(list(arm.state.q_d))
    assert len(network.datagrams) == 1

    sent = PANDA.command.unpack(network.datagrams[0])
    assert sent["message_id"] == network.messages
    assert sent["tau_J_d"] == (0.5,) * 7
    assert sent["q_c"] == tuple(arm.state.q_d)
    assert not sent["motion_generation_finished"]


def test_half_of_a_command_is_not_sent(network, arm):
    arm.start_motion(EXTERNAL, POSITION)
    arm.command_joint_torques([0.5] * 7)
    arm.read_once()
    arm.command_joint_positions(list(arm.state.q_d))
    assert network.datagrams == []


def test_error_of_the_arm_is_named_with_the_cycles_before_it(network, arm):
    arm.start_motion(JOINT, POSITION)
    for _ in range(80):
        arm.command_joint_positions(list(arm.state.q_d))
        arm.read_once()
    network.arm.fail("joint_reflex")
    arm.read_once()

    assert arm.state.robot_mode is RobotMode.REFLEX
    assert error_names(arm.state.current_errors) == ["joint_reflex"]
    assert [error.description for error in arm.errors()] == [
        f"joint_reflex (cycle {network.messages})"
    ]
    assert arm.failure() == "libfranka: Move command aborted: motion aborted by reflex!"
    log = arm.log()
    assert len(log) == 50
    assert [b.time - a.time for a, b in pairwise(log)] == (pytest.approx([0.001] * 49))
    assert log[-1].command == tuple(arm.state.q_d)


def test_silent_arm_is_lost_after_libfrankas_time(network, arm):
    arm.start_motion(JOINT, POSITION)
    arm.wait()
    network.is_silent = True
    for _ in range(round(UDP_TIMEOUT / SLICE) - 1):
        assert arm.wait() == 0
        assert arm.state.robot_mode is RobotMode.MOVE
    assert arm.wait() == 1  # the cycles go on, so that controllers are told

    assert arm.read_once().robot_mode is RobotMode.OTHER
    assert arm.failure() == "libfranka: UDP receive: Timeout"
    assert arm.remedy() == (
        "restore the connection, then recover (libfranka: UDP receive: Timeout)"
    )
    start = lambda: arm.start_motion(JOINT, POSITION)  # noqa: E731
    for refused in (arm.automatic_error_recovery, start):
        with pytest.raises(ArmCommandError, match="UDP receive: Timeout"):
            refused()
    with pytest.raises(ArmCommandError, match="lost"):
        arm.set_joint_impedance([100.0] * 7)


def test_arm_without_any_state_is_not_connected_to(network):
    network.is_silent = True
    with pytest.raises(FciNetworkError, match="UDP receive: Timeout") as error:
        FciArm(network, PlainModel)
    assert "firewall" in error.value.remedy
    assert network.is_closed


def test_states_of_another_size_are_no_states(network):
    wait = network.wait
    network.wait = lambda buffer: wait(buffer) + 1
    with pytest.raises(FciNetworkError, match="UDP receive: Timeout"):
        FciArm(network, PlainModel)
    assert network.is_closed


def test_wait_tells_cycles_that_were_lost_on_the_way(network, arm):
    assert arm.wait() == 1
    network.messages += 4
    assert arm.wait() == 5
    before = arm.state.time
    for _ in range(5):
        assert arm.read_once().time == before
    assert arm.read_once().time == pytest.approx(before + 0.001)


def test_command_for_a_cycle_that_has_passed_is_not_sent(network, arm):
    arm.start_motion(JOINT, POSITION)
    network.messages += 1
    assert arm.wait() == 3  # the start has taken one
    for _ in range(2):
        arm.read_once()
        arm.command_joint_positions(list(arm.state.q_d))
    assert network.datagrams == []
    arm.read_once()
    arm.command_joint_positions(list(arm.state.q_d))
    assert len(network.datagrams) == 1


def test_stop_does_not_wait_for_the_arm(monkeypatch, network, arm):
    arm.start_motion(JOINT, POSITION)
    held = []
    monkeypatch.setattr(
        network.session, "receive", lambda data: held.append(data) or b""
    )
    arm.stop_motion()
    assert arm.state.robot_mode is RobotMode.IDLE
    assert arm.is_stopping()
    assert not arm.is_at_rest()
    with pytest.raises(ArmCommandError, match="still coming to rest"):
        arm.start_motion(JOINT, POSITION)

    arm.read_once()
    assert arm.state.robot_mode is RobotMode.IDLE  # though the arm still says Move
    monkeypatch.undo()
    network.send(held[0])
    arm.read_once()
    assert not arm.is_stopping()
    arm.start_motion(JOINT, POSITION)


def test_recovery_that_needs_a_person_is_told(monkeypatch, network, arm):
    arm.start_motion(JOINT, POSITION)
    arm.command_joint_positions(list(arm.state.q_d))
    for _ in range(MOST_LOST_PACKETS + 1):
        arm.read_once()
    answering(monkeypatch, network, Command.AUTOMATIC_ERROR_RECOVERY, 2)
    arm.automatic_error_recovery()
    arm.read_once()
    assert arm.remedy() == (
        "remove the cause, then recover (libfranka: Automatic Error Recovery command "
        "rejected: manual error recovery required!)"
    )


def test_broken_connection_in_a_motion_loses_the_arm(monkeypatch, network, arm):
    arm.start_motion(JOINT, POSITION)

    def broken(_data):
        raise FciNetworkError("libfranka: TCP send bytes: broken pipe")

    monkeypatch.setattr(network, "send", broken)
    arm.stop_motion()
    assert arm.state.robot_mode is RobotMode.OTHER
    assert "broken pipe" in arm.failure()


def test_arm_that_falls_silent_after_it_has_accepted_a_motion_is_lost(
    monkeypatch, network, arm
):
    serve = network.session.receive

    def fall_silent(data):
        network.is_silent = True
        return serve(data)

    monkeypatch.setattr(network.session, "receive", fall_silent)
    with pytest.raises(ArmCommandError, match="arm is lost: libfranka: UDP receive"):
        arm.start_motion(JOINT, POSITION)
    assert arm.is_lost()


def test_connection_that_breaks_while_two_answers_are_due_loses_the_arm(
    monkeypatch, network, arm
):
    arm.start_motion(JOINT, POSITION)
    monkeypatch.setattr(network, "receive", lambda _timeout: b"")
    network.arm.fail("joint_reflex")
    arm.read_once()
    arm.automatic_error_recovery()

    def broken(_timeout):
        if network.is_closed:
            raise ValueError("file descriptor cannot be a negative integer (-1)")
        raise FciNetworkError("libfranka: server closed connection")

    monkeypatch.setattr(network, "receive", broken)
    arm.read_once()
    assert arm.is_lost()
    assert arm.failure() == "libfranka: server closed connection"
