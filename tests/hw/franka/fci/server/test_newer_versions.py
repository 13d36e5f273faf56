"""What a client of versions 7 to 10 may ask of a session, and older ones may not."""

from math import inf, nan

import pytest

from station.core.franka import RobotMode
from station.core.franka.franka_errors import ERROR_INDEX
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    Command,
    MoveController,
    MoveGenerator,
    Status,
)
from tests.hw.franka.fci.server.robot_client import RobotClient, request
from tests.hw.franka.scripted_arm import ScriptedArm

TARGET = [0.1, -0.5, 0.2, -2.0, 0.1, 1.8, 0.5]
FASTEST = (0.5, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0)
ASYNC = {"use_async_motion_generator": True, "maximum_velocity": FASTEST}


def connected(version, robot_model=""):
    """Return a client of a version that has seen a state."""
    client = RobotClient(ScriptedArm(), version=version, robot_model=robot_model)
    assert client.connect() == [Status.SUCCESS]
    client.cycle()
    return client


@pytest.fixture
def client():
    return connected(10)


@pytest.mark.parametrize(("version", "is_single"), [(9, False), (10, True)])
def test_limits_allow_for_single_precision_while_such_a_client_moves(
    monkeypatch, version, is_single
):
    said = []

    class Simulation:
        def set_state_precision(self, *, is_single):
            said.append(is_single)

    monkeypatch.setattr(ScriptedArm, "simulation", lambda _: Simulation())
    client = connected(version)
    assert client.move() == [Status.MOTION_STARTED]
    client.cycle()
    assert said == [is_single]
    client.session.close()
    assert said == [is_single, False]


@pytest.fixture
def planning(client):
    """A client whose asynchronous motion has begun."""
    assert client.move(**ASYNC) == [Status.MOTION_STARTED]
    client.cycle()
    return client


@pytest.mark.parametrize(("version", "number"), [(8, 12), (9, 12), (10, 11)])
def test_model_is_a_urdf_behind_its_status(version, number):
    client = connected(version, "<robot name='fr3'/>")
    data = client.session.receive(HEADER.pack({"command": number, "size": 12}))
    assert HEADER.unpack(data[:12]) == {"command": number, "command_id": 0, "size": 32}
    assert data[12:] == b"\x00<robot name='fr3'/>"


def test_an_arm_without_a_model_says_so(client):
    refused = [Status.COMMAND_NOT_POSSIBLE_REJECTED]
    assert client.ask(Command.GET_ROBOT_MODEL) == refused


@pytest.mark.parametrize(("version", "number"), [(7, 12), (10, 12)])
def test_commands_that_a_version_lacks_are_unknown(version, number):
    with pytest.raises(FciProtocolError, match=f"command {number}, which"):
        connected(version).session.receive(HEADER.pack({"command": number, "size": 12}))


def test_move_of_an_older_version_is_too_short(client):
    older = connected(9)
    data = request(Command.MOVE, 7, {}, older.protocol)
    assert len(older.session.receive(data)) == 13
    with pytest.raises(FciProtocolError, match="68 bytes; the protocol has 125"):
        client.session.receive(data)


def test_target_is_sent_once_and_cycles_without_a_command_are_no_loss(planning):
    planning.send(q_c=TARGET)
    for _ in range(100):
        state, statuses = planning.cycle()
        assert statuses == []
    assert planning.arm.sent == [TARGET]
    assert planning.arm.fastest == FASTEST
    assert not planning.session.is_answering
    assert (state["motion_generator_mode"], state["controller_mode"]) == (1, 0)
    assert state["robot_mode"] == RobotMode.MOVE.value


def test_newest_of_two_targets_counts_although_no_state_was_read_between(planning):
    planning.send(q_c=[0.0] * 7)
    planning.send(q_c=TARGET)
    planning.cycle()
    planning.send(planning.messages - 2, q_c=[0.5] * 7)  # a late one
    planning.cycle()
    assert planning.arm.sent == [TARGET]


def test_last_command_has_no_target(planning):
    planning.send(q_c=TARGET)
    planning.cycle()
    planning.send(q_c=[0.0] * 7, motion_generation_finished=True)
    state, statuses = planning.cycle()
    assert statuses == [Status.SUCCESS]
    assert planning.arm.sent == [TARGET]
    assert state["robot_mode"] == RobotMode.IDLE.value
    assert (state["motion_generator_mode"], state["controller_mode"]) == (0, 3)
    # The next motion owes a command to every cycle again.
    planning.move()
    planning.cycle()
    planning.send(q_c=TARGET)
    for _ in range(20):
        planning.cycle()
    assert planning.cycle()[0]["robot_mode"] == RobotMode.REFLEX.value


def test_target_that_is_not_finite_ends_the_motion(planning):
    planning.send(q_c=[nan] * 7)
    assert planning.cycle()[1] == [Status.INPUT_ERROR_ABORTED]


@pytest.mark.parametrize(
    "wrong",
    [
        {"generator": MoveGenerator.JOINT_VELOCITY},
        {"controller": MoveController.EXTERNAL_CONTROLLER},
        {"maximum_velocity": (0.0,) * 7},
        {"maximum_velocity": (*FASTEST[:6], inf)},
        {"maximum_velocity": (nan,) * 7},
    ],
)
def test_impossible_asynchronous_motion_is_rejected(client, wrong):
    assert client.move(**ASYNC | wrong) == [Status.INVALID_ARGUMENT_REJECTED]
    assert client.arm.state.robot_mode is RobotMode.IDLE


@pytest.mark.parametrize("version", [7, 8, 9, 10])
def test_torques_alone_show_their_modes_and_end_by_their_own_byte(version):
    client = connected(version)
    client.move(MoveController.EXTERNAL_CONTROLLER, MoveGenerator.NONE)
    state, _ = client.cycle()
    assert (state["motion_generator_mode"], state["controller_mode"]) == (5, 2)
    client.send(tau_J_d=[1.0] * 7)
    client.cycle()
    client.send(tau_J_d=[0.5] * 7, torque_command_finished=True)
    assert client.cycle()[1] == [Status.SUCCESS]
    assert client.arm.sent == [[1.0] * 7, [0.5] * 7]


@pytest.mark.parametrize("version", range(5, 11))
def test_position_limits_of_motions_are_merged_from_version_9_on(version):
    client = connected(version)
    names = (
        "joint_motion_generator_position_limits_violation",
        "cartesian_motion_generator_joint_position_limits_violation",
        "joint_reflex",
    )
    for name in names:
        client.arm.state.last_motion_errors[ERROR_INDEX[name]] = True
    state, _ = client.cycle()
    raised = [i for i, flag in enumerate(state["reflex_reason"]) if flag]
    assert raised == ([0, 6] if version > 8 else [6, 12, 27])
    assert not any(state["errors"])


@pytest.mark.parametrize("version", range(5, 11))
def test_state_has_the_arms_numbers_in_every_version(version):
    client = connected(version)
    state = client.arm.state
    arrays = [n for n, c in client.protocol.state.counts.items() if 1 < c < 17]
    for i, name in enumerate(arrays):
        size = client.protocol.state.counts[name]
        setattr(state, name, [i + 0.25 + k / 32 for k in range(size)])
    state.m_ee, state.m_load, state.control_command_success_rate = 0.7, 0.3, 0.5
    readings = [float(k) for k in range(18)], [-float(k) for k in range(18)]
    client.arm.accelerometers = lambda: readings
    client.arm.read_once = client.arm.refresh_state = lambda: None
    found, _ = client.cycle()
    for i, name in enumerate(arrays):
        size = client.protocol.state.counts[name]
        assert found[name] == tuple(i + 0.25 + k / 32 for k in range(size))
    assert (found["m_ee"], found["m_load"]) == pytest.approx((0.7, 0.3), abs=1e-7)
    assert found["control_command_success_rate"] == 0.5
    if version == 10:
        assert found["accelerometer_top"] == tuple(readings[0])
        assert found["accelerometer_bottom"] == tuple(readings[1])


def test_arm_that_tells_no_accelerations_leaves_them_zero(client):
    state, _ = client.cycle()
    assert state["accelerometer_top"] == (0.0,) * 18
