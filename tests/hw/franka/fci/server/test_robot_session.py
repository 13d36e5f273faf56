"""The session of one client: what libfranka's own tests expect of a robot, and more.

Source of the scenarios: libfranka@0.9.2 test/robot_impl_tests.cpp,
test/robot_command_tests.cpp, test/model_tests.cpp, retold for the robot's side.
"""

from math import inf, nan

import pytest

from station.core.franka import RobotMode
from station.core.franka.franka_errors import ERROR_INDEX
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    NO_GENERATOR,
    PANDA,
    Architecture,
    Command,
    MoveController,
    MoveGenerator,
    Status,
    System,
)
from tests.hw.franka.fci.server.robot_client import (
    UDP_PORT,
    RobotClient,
    answers,
    request,
    statuses,
)

LOST = "communication_constraints_violation"


def q_of(arm, delta=0.0):
    return [q + delta for q in arm.state.q_d]


def begin(client):
    """Begin a motion and command it for one cycle."""
    assert client.move() == [Status.MOTION_STARTED]
    client.cycle()
    client.send(q_c=q_of(client.arm))
    client.cycle()


def test_connection_names_the_version_and_keeps_the_port(arm):
    client = RobotClient(arm)
    assert client.connect() == [Status.SUCCESS]
    assert client.received == [(Command.CONNECT, 1, {"status": 0, "version": 5})]
    assert client.session.udp_port == UDP_PORT


@pytest.mark.parametrize("version", [0, 4, 6, 10])
def test_other_versions_are_told_the_own_one_and_are_not_connected(arm, version):
    client = RobotClient(arm)
    asked = f"asked for version {version} of the arm's protocol; spoken is 5"
    with pytest.raises(FciProtocolError, match=asked) as caught:
        client.connect(version)
    told = caught.value.answers
    assert answers(told) == [(Command.CONNECT, 1, {"status": 1, "version": 5})]
    assert statuses(told) == [Status.INCOMPATIBLE_LIBRARY_VERSION]
    assert client.session.udp_port is None
    with pytest.raises(FciProtocolError, match="before it had connected"):
        client.move()


def test_second_connection_in_one_session_is_a_protocol_error(client):
    with pytest.raises(FciProtocolError, match="second time"):
        client.connect()


@pytest.mark.parametrize("generator", PANDA.generators)
@pytest.mark.parametrize("controller", MoveController)
def test_motion_starts_and_shows_its_modes(client, controller, generator):
    assert client.move(controller, generator) == [Status.MOTION_STARTED]
    state, statuses = client.cycle()
    assert statuses == []
    assert state["motion_generator_mode"] == generator + 1
    assert state["controller_mode"] == controller
    assert state["robot_mode"] == RobotMode.MOVE.value


COMMANDS = {
    MoveGenerator.JOINT_POSITION: {"q_c": [0.3] * 7},
    MoveGenerator.JOINT_VELOCITY: {"dq_c": [0.4] * 7},
    MoveGenerator.CARTESIAN_POSITION: {"O_T_EE_c": [*IDENTITY]},
    MoveGenerator.CARTESIAN_VELOCITY: {"O_dP_EE_c": [0.5] * 6},
}


@pytest.mark.parametrize("generator", PANDA.generators)
def test_command_reaches_the_arm_and_torques_go_with_the_external_controller(
    client, arm, generator
):
    values = COMMANDS[generator]
    client.move(MoveController.EXTERNAL_CONTROLLER, generator)
    client.cycle()
    client.send(**values, tau_J_d=[1.0] * 7)
    client.cycle()
    assert [1.0] * 7 in arm.sent
    assert list(*values.values()) in arm.sent


def test_finished_motion_is_applied_answered_with_success_and_over(client, arm):
    begin(client)
    client.send(q_c=q_of(arm), motion_generation_finished=True)
    state, statuses = client.cycle()
    assert statuses == [Status.SUCCESS]
    assert state["motion_generator_mode"] == NO_GENERATOR
    assert state["robot_mode"] == RobotMode.IDLE.value
    assert client.received[-1][:2] == (Command.MOVE, 2)  # the number of the Move


def test_stop_preempts_the_motion_and_then_succeeds(client):
    begin(client)
    assert client.ask(Command.STOP_MOVE) == [
        Status.PREEMPTED,
        Status.SUCCESS,
    ]
    assert [r[0] for r in client.received[-2:]] == [Command.MOVE, Command.STOP_MOVE]
    state, _ = client.cycle()
    assert state["robot_mode"] == RobotMode.IDLE.value
    assert client.ask(Command.STOP_MOVE) == [Status.SUCCESS]


def slow_down(arm, monkeypatch):
    """Let the arm read a desired velocity until the returned list is emptied."""
    speeds, read = [0.4], arm.read_once

    def read_once():
        state = read()
        state.dq_d = [*speeds, *[0.0] * 6] if speeds else [0.0] * 7
        return state

    monkeypatch.setattr(arm, "read_once", read_once)
    return speeds


@pytest.mark.parametrize("end", ["stop", "finish"])
def test_motion_waits_until_the_arm_has_slowed_down(client, arm, monkeypatch, end):
    begin(client)
    speeds = slow_down(arm, monkeypatch)
    client.cycle()
    if end == "stop":
        assert client.ask(Command.STOP_MOVE) == [Status.PREEMPTED, Status.SUCCESS]
    else:
        client.send(q_c=q_of(arm), motion_generation_finished=True)
        assert client.cycle()[1] == [Status.SUCCESS]
    assert client.move() == []
    for _ in range(3):
        state, told = client.cycle()
        assert (told, state["motion_generator_mode"]) == ([], NO_GENERATOR)
    speeds.clear()
    state, told = client.cycle()
    assert told == [Status.MOTION_STARTED]
    assert state["robot_mode"] == RobotMode.MOVE.value


def test_error_refuses_a_motion_that_waits(client, arm, monkeypatch):
    begin(client)
    slow_down(arm, monkeypatch)
    client.cycle()
    client.ask(Command.STOP_MOVE)
    assert client.move() == []
    arm.fail("cartesian_reflex")
    assert client.cycle()[1] == [Status.COMMAND_NOT_POSSIBLE_REJECTED]


def test_stop_preempts_a_motion_that_waits(client, arm, monkeypatch):
    begin(client)
    speeds = slow_down(arm, monkeypatch)
    client.cycle()
    client.ask(Command.STOP_MOVE)
    assert client.move() == []
    assert client.ask(Command.STOP_MOVE) == [Status.PREEMPTED, Status.SUCCESS]
    speeds.clear()
    state, told = client.cycle()
    assert (told, state["robot_mode"]) == ([], RobotMode.IDLE.value)


def test_second_motion_is_rejected_and_the_first_goes_on(client, arm):
    begin(client)
    assert client.move() == [Status.COMMAND_NOT_POSSIBLE_REJECTED]
    client.send(q_c=q_of(arm))
    state, statuses = client.cycle()
    assert statuses == []
    assert state["robot_mode"] == RobotMode.MOVE.value


@pytest.mark.parametrize(
    "wrong",
    [
        {"controller_mode": 3},
        {"motion_generator_mode": 4},
        {"maximum_path_deviation": (-1.0, 0.0, 0.0)},
        {"maximum_goal_pose_deviation": (inf, 0.0, 0.0)},
    ],
)
def test_impossible_motion_is_rejected_and_none_starts(client, arm, wrong):
    good = {"maximum_path_deviation": (1.0,) * 3}
    rejected = client.ask(Command.MOVE, **good | wrong)
    assert rejected == [Status.INVALID_ARGUMENT_REJECTED]
    assert arm.state.robot_mode is RobotMode.IDLE


def test_error_aborts_the_motion_with_its_flag_and_number(client, arm):
    begin(client)
    arm.fail("cartesian_reflex")
    state, statuses = client.cycle()
    assert statuses == [Status.REFLEX_ABORTED]
    assert state["robot_mode"] == RobotMode.REFLEX.value
    assert state["errors"].index(True) == ERROR_INDEX["cartesian_reflex"] == 7
    assert client.move() == [Status.COMMAND_NOT_POSSIBLE_REJECTED]
    stop = client.ask(Command.STOP_MOVE)
    assert stop == [Status.COMMAND_NOT_POSSIBLE_REJECTED]


def test_user_stop_aborts_the_motion_as_an_emergency(client, arm):
    begin(client)
    arm.state.robot_mode = RobotMode.USER_STOPPED
    assert client.cycle()[1] == [Status.EMERGENCY_ABORTED]


def test_twenty_lost_packets_abort_and_nineteen_do_not(client, arm):
    begin(client)
    for _ in range(19):
        assert client.cycle()[1] == []
    assert client.cycle()[1] == [Status.REFLEX_ABORTED]
    assert arm.errors()[0].name == LOST


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_old_repeated_and_malformed_datagrams_are_lost_packets(client, arm, delay):
    begin(client)
    newest = client.messages
    client.send(newest, q_c=q_of(arm))
    client.cycle()
    sent = len(arm.sent)
    client.send(newest - delay, q_c=q_of(arm))
    client.session.receive_command(b"too short")
    client.session.receive_command(bytes(PANDA.command.size + 1))
    client.cycle()
    assert len(arm.sent) == sent


def test_newest_of_several_commands_counts(client, arm):
    begin(client)
    newest = client.messages
    client.send(newest + 2, q_c=q_of(arm, 1e-6))
    client.send(newest + 1, q_c=q_of(arm, 1e-3))
    wanted = q_of(arm, 1e-6)
    client.cycle()
    assert arm.sent[-1] == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("bad", [nan, inf])
def test_command_that_is_not_finite_aborts_as_an_input_error(client, arm, bad):
    begin(client)
    client.send(q_c=[bad] * 7)
    assert client.cycle()[1] == [Status.INPUT_ERROR_ABORTED]
    assert arm.state.robot_mode is RobotMode.IDLE


def test_impossible_elbow_aborts_as_an_input_error(client):
    client.move(generator=MoveGenerator.CARTESIAN_POSITION)
    client.cycle()
    client.send(O_T_EE_c=[*IDENTITY], valid_elbow=True, elbow_c=(0.0, 0.5))
    assert client.cycle()[1] == [Status.INPUT_ERROR_ABORTED]


def test_commands_without_a_motion_do_nothing(client, arm):
    client.send(q_c=[1.0] * 7)
    assert client.cycle()[1] == []
    assert arm.sent == []


def test_recovery_is_answered_when_it_is_over(client, arm):
    arm.fail("joint_reflex")
    assert client.ask(Command.AUTOMATIC_ERROR_RECOVERY) in ([], [Status.SUCCESS])
    client.cycle()
    assert client.received[-1] == (
        Command.AUTOMATIC_ERROR_RECOVERY,
        client.ids,
        {"status": 0},
    )
    assert client.move() == [Status.MOTION_STARTED]


def test_recovery_of_an_arm_without_errors_succeeds_and_of_a_moving_one_does_not(
    client,
):
    assert client.ask(Command.AUTOMATIC_ERROR_RECOVERY) == [Status.SUCCESS]
    begin(client)
    rejected = client.ask(Command.AUTOMATIC_ERROR_RECOVERY)
    assert rejected == [Status.COMMAND_NOT_POSSIBLE_REJECTED]


def test_there_are_no_virtual_walls(client):
    assert client.ask(Command.GET_CARTESIAN_LIMIT, id=3) == [Status.SUCCESS]
    assert client.received[-1][2]["object_activation"] is False


def test_model_library_follows_its_status_or_is_refused(arm):
    body = {"architecture": Architecture.X64, "system": System.LINUX}
    client = RobotClient(arm, {tuple(body.values()): b"\x7fELF"})
    client.connect()
    data = client.session.receive(request(Command.LOAD_MODEL_LIBRARY, 9, body))
    assert HEADER.unpack(data[:12]) == {"command": 13, "command_id": 9, "size": 17}
    assert data[12:] == b"\x00\x7fELF"
    for other in ({"architecture": Architecture.ARM}, {"system": System.WINDOWS}):
        refused = client.ask(Command.LOAD_MODEL_LIBRARY, **body | other)
        assert refused == [Status.ERROR]


def test_client_that_goes_while_its_motion_runs_leaves_the_arm_at_rest(client, arm):
    begin(client)
    client.session.close()
    assert arm.state.robot_mode is RobotMode.IDLE
    assert not client.session.is_moving
