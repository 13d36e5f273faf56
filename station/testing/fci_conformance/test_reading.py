"""Checks that read: the handshake, the states, the settings, the model.

Settings are set to the values that they have, or to those that libfranka's examples
begin with. Nothing moves.
"""

from collections.abc import Mapping
from itertools import pairwise
from math import hypot, isfinite, nan
from socket import gethostbyname
from xml.etree import ElementTree

import pytest

from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.franka_kinematics import IDENTITY, frame_pose
from station.hw.franka.fci.wire.robot_protocol import (
    NO_CONTROLLER,
    NO_GENERATOR,
    PROTOCOLS,
    Architecture,
    Command,
    ConnectStatus,
    LibraryStatus,
    ModelStatus,
    RecoveryStatus,
    SetterStatus,
    StopMoveStatus,
    System,
)
from station.testing.fci_conformance.dialog import (
    Dialog,
    Endpoint,
    State,
    ask_version,
    open_network,
    words,
)
from station.testing.fci_conformance.plugin import Row

GRAVITY = 9.81
SAME_POSE = 0.01
"""Largest distance of O_T_EE from the textbook kinematics: real arms are calibrated."""
THRESHOLDS = {
    **{
        f"{bound}_torque_thresholds_{phase}": (20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0)
        for bound in ("lower", "upper")
        for phase in ("acceleration", "nominal")
    },
    **{
        f"{bound}_force_thresholds_{phase}": (20.0, 20.0, 20.0, 25.0, 25.0, 25.0)
        for bound in ("lower", "upper")
        for phase in ("acceleration", "nominal")
    },
}
"""Thresholds of libfranka's examples. Source: libfranka@0.9.2
examples/examples_common.cpp, setDefaultBehavior."""
STIFFNESS = (3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0)
IMPOSSIBLE: Mapping[Command, Mapping[str, object]] = {
    Command.SET_JOINT_IMPEDANCE: {"K_theta": (-1.0,) * 7},
    Command.SET_CARTESIAN_IMPEDANCE: {"K_x": (1e6,) * 6},
    Command.SET_EE_TO_K: {"EE_T_K": (2.0,) * 16},
    Command.SET_NE_TO_EE: {"NE_T_EE": (nan,) * 16},
    Command.SET_LOAD: {"m_load": -1.0, "I_load": (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)},
}
SETTERS = [command for command in Command if command.name.startswith("SET_")]


def values_of(command: Command, dialog: Dialog) -> dict[str, object]:
    """Return values for a setter that change nothing, or are those of the examples."""
    state = dialog.state
    match command:
        case Command.SET_COLLISION_BEHAVIOR:
            return {**THRESHOLDS}
        case Command.SET_JOINT_IMPEDANCE:
            return {"K_theta": STIFFNESS}
        case Command.SET_CARTESIAN_IMPEDANCE:
            return {"K_x": (3000.0,) * 3 + (300.0,) * 3}
        case Command.SET_GUIDING_MODE:
            return {"guiding_mode": (True,) * 6, "nullspace": True}
        case Command.SET_FILTERS:
            filters = dialog.protocol.exchanges[command].request.offsets
            return dict.fromkeys(filters, 1000.0)
    fields = dialog.protocol.exchanges[command].request.offsets
    return {name: state[name] for name in fields}


def test_version_is_agreed(row: Row, endpoint: Endpoint) -> None:
    version = endpoint.protocol.version
    row.expect(f"Connect with version {version}: success, version {version}")
    status, told = ask_version(endpoint.host, endpoint.port, version)
    row.see(f"{words(ConnectStatus, status)}, version {told}")
    assert (status, told) == (ConnectStatus.SUCCESS, version)


@pytest.mark.parametrize("version", [1, 999])
def test_wrong_version_is_refused_with_the_right_one(
    row: Row, endpoint: Endpoint, version: int
) -> None:
    """Incompatible library version, and a version of the robot."""
    status, told = ask_version(endpoint.host, endpoint.port, version)
    row.see(f"{words(ConnectStatus, status)}, version {told}")
    assert status == ConnectStatus.INCOMPATIBLE_LIBRARY_VERSION
    assert told in PROTOCOLS


def test_refused_client_may_connect_again_at_once(row: Row, endpoint: Endpoint) -> None:
    """A connection and a state after a refused version."""
    ask_version(endpoint.host, endpoint.port, 999)
    with_state = endpoint.open()
    with_state.close()
    row.see("connected")
    assert with_state.state


def test_request_that_tcp_has_cut_is_read(row: Row, endpoint: Endpoint) -> None:
    """Connect in two pieces: success."""
    network = open_network(endpoint.host, endpoint.port)
    dialog = Dialog(network, endpoint.protocol)
    send = network.send

    def send_in_pieces(data: bytes) -> None:
        send(data[:7])
        network.receive(0.02)
        send(data[7:])

    network.send = send_in_pieces  # type: ignore[method-assign]
    try:
        dialog.connect()
        row.see("success")
        assert dialog.next_state()
    finally:
        dialog.close()


def test_states_have_their_size(row: Row, dialog: Dialog) -> None:
    row.expect(f"{dialog.protocol.state.size} bytes")
    for _ in range(20):
        dialog.next_state()
    row.see(", ".join(f"{size} bytes" for size in sorted(dialog.sizes)))
    assert dialog.sizes == {dialog.protocol.state.size}


def test_states_come_from_the_address_of_the_robot(
    row: Row, dialog: Dialog, endpoint: Endpoint
) -> None:
    wanted = gethostbyname(endpoint.host)
    row.expect(f"states from {wanted}: firewalls and cautious clients drop others")
    row.see(f"states from {dialog.network.sender}")
    assert dialog.network.sender == wanted


def test_numbers_of_states_rise_by_one(row: Row, dialog: Dialog) -> None:
    """Message_id one higher than the last in 95 of 100 states."""
    dialog.settle()
    ids = [dialog.next_state()["message_id"] for _ in range(101)]
    steps = [after - before for before, after in pairwise(ids)]
    row.see(f"{steps.count(1)} of 100 steps are 1, the largest is {max(steps)}")
    assert steps.count(1) >= 95


def test_idle_arm_shows_its_modes(row: Row, dialog: Dialog) -> None:
    """Generator 0, controller 3, robot mode 1 (idle), no present error."""
    state = dialog.settle()
    modes = state["motion_generator_mode"], state["controller_mode"]
    row.see(
        f"generator {modes[0]}, controller {modes[1]}, robot mode "
        f"{state['robot_mode']}, {sum(state['errors'])} errors"
    )
    assert modes == (NO_GENERATOR, NO_CONTROLLER)
    assert state["robot_mode"] == RobotMode.IDLE.value
    assert not any(state["errors"])


def test_all_numbers_are_finite(row: Row, dialog: Dialog) -> None:
    """No NaN and no infinity in any field."""
    state = dialog.settle()
    wrong = [
        name
        for name, value in state.items()
        if not all(map(isfinite, value if isinstance(value, tuple) else (value,)))
    ]
    row.see(", ".join(wrong) or "all finite")
    assert not wrong


def test_pose_agrees_with_the_joints(row: Row, dialog: Dialog) -> None:
    row.expect(f"O_T_EE within {SAME_POSE:g} of the kinematics of q and F_T_EE")
    state = dialog.settle()
    pose = frame_pose(Frame.END_EFFECTOR, state["q"], state["F_T_EE"])
    away = max(abs(a - b) for a, b in zip(pose, state["O_T_EE"], strict=True))
    row.see(f"{away:.2g} away")
    assert away < SAME_POSE


def test_end_effector_is_composed_of_its_frames(row: Row, dialog: Dialog) -> None:
    """F_T_NE times NE_T_EE is F_T_EE."""
    state = dialog.settle()
    first, second = state["F_T_NE"], state["NE_T_EE"]
    product = [
        sum(first[4 * k + r] * second[4 * c + k] for k in range(4))
        for c in range(4)
        for r in range(4)
    ]
    away = max(abs(a - b) for a, b in zip(product, state["F_T_EE"], strict=True))
    row.see(f"{away:.2g} away")
    assert away < 1e-4


def test_joints_rest_where_they_are_desired(row: Row, dialog: Dialog) -> None:
    """Q within 0.02 rad of q_d, dq below 0.05 rad/s."""
    state = dialog.settle()
    away = max(abs(a - b) for a, b in zip(state["q"], state["q_d"], strict=True))
    fast = max(map(abs, state["dq"]))
    row.see(f"{away:.2g} rad away, {fast:.2g} rad/s")
    assert away < 0.02
    assert fast < 0.05


def test_gravity_is_told(row: Row, dialog: Dialog) -> None:
    row.expect(f"O_ddP_O of {GRAVITY} m/s², which clients' models take for gravity")
    told = dialog.settle()["O_ddP_O"]
    row.see(f"({', '.join(f'{value:.3g}' for value in told)}) m/s²")
    assert abs(hypot(*told) - GRAVITY) < 0.2


def test_accelerometers_feel_gravity(row: Row, dialog: Dialog) -> None:
    state = dialog.settle()
    row.needs("accelerometer_top" in state)
    row.expect(f"{GRAVITY} ± 1.5 m/s² at each of the twelve boards of an arm at rest")
    values = (*state["accelerometer_top"], *state["accelerometer_bottom"])
    felt = [hypot(*values[i : i + 3]) for i in range(0, 36, 3)]
    row.see(f"{min(felt):.3g} to {max(felt):.3g} m/s²")
    assert all(abs(one - GRAVITY) < 1.5 for one in felt)


def test_load_of_the_end_effector_is_possible(row: Row, dialog: Dialog) -> None:
    """Masses of 0 to 10 kg, no negative moment of inertia."""
    state = dialog.settle()
    row.see(f"m_ee {state['m_ee']:.3g} kg, m_load {state['m_load']:.3g} kg")
    assert all(0.0 <= state[mass] < 10.0 for mass in ("m_ee", "m_load"))
    assert all(state[i][k] >= 0.0 for i in ("I_ee", "I_load") for k in (0, 4, 8))


@pytest.mark.parametrize("command", SETTERS, ids=lambda c: c.name.lower())
def test_possible_setting_is_accepted(
    row: Row, dialog: Dialog, command: Command
) -> None:
    """Success."""
    row.needs(command in dialog.protocol.exchanges)
    answer = dialog.ask(command, **values_of(command, dialog))
    row.see(words(SetterStatus, answer.status))
    assert answer.status == SetterStatus.SUCCESS


@pytest.mark.parametrize("command", IMPOSSIBLE, ids=lambda c: c.name.lower())
def test_impossible_setting_is_refused(
    row: Row, dialog: Dialog, command: Command
) -> None:
    """Invalid argument rejected."""
    answer = dialog.ask(command, **IMPOSSIBLE[command])
    row.see(words(SetterStatus, answer.status))
    if answer.status == SetterStatus.SUCCESS:  # undone, as far as it can be
        dialog.ask(command, **values_of(command, dialog))
    assert answer.status == SetterStatus.INVALID_ARGUMENT_REJECTED


def test_virtual_walls_are_told(row: Row, dialog: Dialog) -> None:
    """Success."""
    row.needs(Command.GET_CARTESIAN_LIMIT in dialog.protocol.exchanges)
    answer = dialog.ask(Command.GET_CARTESIAN_LIMIT, id=0)
    row.see(words(SetterStatus, answer.status))
    assert answer.status == SetterStatus.SUCCESS


def test_stop_of_an_idle_arm_succeeds(row: Row, dialog: Dialog) -> None:
    """Success."""
    answer = dialog.ask(Command.STOP_MOVE)
    row.see(words(StopMoveStatus, answer.status))
    assert answer.status == StopMoveStatus.SUCCESS


def test_recovery_without_an_error_succeeds(row: Row, dialog: Dialog) -> None:
    """Success."""
    answer = dialog.ask(Command.AUTOMATIC_ERROR_RECOVERY)
    row.see(words(RecoveryStatus, answer.status))
    assert answer.status == RecoveryStatus.SUCCESS


def test_model_library_is_sent(row: Row, dialog: Dialog) -> None:
    """Success, and an ELF library for x86-64 Linux."""
    row.needs(Command.LOAD_MODEL_LIBRARY in dialog.protocol.exchanges)
    values = {"architecture": Architecture.X64, "system": System.LINUX}
    answer = dialog.ask(Command.LOAD_MODEL_LIBRARY, **values)
    row.see(f"{words(LibraryStatus, answer.status)}, {len(answer.rest)} bytes")
    assert answer.status == LibraryStatus.SUCCESS
    assert answer.rest.startswith(b"\x7fELF")


def test_robot_model_is_what_libfranka_parses(row: Row, dialog: Dialog) -> None:
    row.needs(Command.GET_ROBOT_MODEL in dialog.protocol.exchanges)
    row.expect(
        "a URDF: links link0 to link8, link1 to link7 with masses; joints joint1 to "
        "joint7 with limits, and with position_based_velocity_limits"
    )
    answer = dialog.ask(Command.GET_ROBOT_MODEL)
    row.see(f"{words(ModelStatus, answer.status)}, {len(answer.rest)} bytes")
    assert answer.status == ModelStatus.SUCCESS
    robot = ElementTree.fromstring(answer.rest)
    links = {one.get("name"): one for one in robot.iter("link")}
    joints = {one.get("name"): one for one in robot.iter("joint")}
    lacks = [f"link{i}" for i in range(9) if f"link{i}" not in links]
    lacks += [f"joint{i}" for i in range(1, 8) if f"joint{i}" not in joints]
    if not lacks:
        lacks = [
            f"{part} of {kind}{i}"
            for kind, found, part in (
                ("link", links, "inertial/mass"),
                ("joint", joints, "limit"),
                ("joint", joints, "position_based_velocity_limits"),
            )
            for i in range(1, 8)
            if found[f"{kind}{i}"].find(part) is None
        ]
    row.see(f"{len(answer.rest)} bytes; missing: {', '.join(lacks) or 'nothing'}")
    assert not lacks


def test_frames_and_load_are_shown_as_they_were_set(row: Row, dialog: Dialog) -> None:
    """EE_T_K of a state after SetEEToK is the frame that was set."""
    before = dialog.settle()["EE_T_K"]
    frame = (*IDENTITY[:12], 0.0, 0.0, 0.01, 1.0)
    dialog.ask(Command.SET_EE_TO_K, EE_T_K=frame)

    def is_shown(state: State) -> bool:
        pairs = zip(state["EE_T_K"], frame, strict=True)
        return all(abs(a - b) < 1e-6 for a, b in pairs)

    shown = dialog.wait_until(is_shown, 0.5)
    row.see("it is" if shown else f"EE_T_K {dialog.state['EE_T_K']}")
    dialog.ask(Command.SET_EE_TO_K, EE_T_K=before)
    assert shown
