"""Checks that read: the handshake, the states, the settings, the model.

The checks set settings to their present values, or to those with which libfranka's
examples begin. Nothing moves.
"""

from collections.abc import Mapping
from contextlib import closing
from dataclasses import asdict
from itertools import pairwise
from math import hypot, nan
from socket import gethostbyname
from xml.etree import ElementTree

import numpy as np
import pytest

from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.arm.franka_kinematics import IDENTITY, compose, frame_pose
from station.hw.franka.fci.wire.robot_protocol import (
    NO_CONTROLLER,
    NO_GENERATOR,
    PROTOCOLS,
    Architecture,
    Command,
    System,
)
from station.testing.fci_conformance.dialog import (
    SUCCESS,
    Dialog,
    Endpoint,
    Verdict,
    ask_version,
    open_network,
)
from station.testing.fci_conformance.plugin import Row, needs
from station.testing.fci_conformance.trajectories import State, farthest

GRAVITY = 9.81
SAME_POSE = 0.01
"""Largest error of O_T_EE by textbook kinematics, as real arms are calibrated."""
POSSIBLE: Mapping[Command, Mapping[str, object]] = {
    Command.SET_COLLISION_BEHAVIOR: asdict(DEFAULT_COLLISION_BEHAVIOR),
    Command.SET_JOINT_IMPEDANCE: {"K_theta": (3e3,) * 3 + (2500.0,) * 2 + (2e3,) * 2},
    Command.SET_CARTESIAN_IMPEDANCE: {"K_x": (3000.0,) * 3 + (300.0,) * 3},
    Command.SET_GUIDING_MODE: {"guiding_mode": (True,) * 6, "nullspace": True},
}
"""Settings of libfranka's examples. Source: libfranka@0.9.2
examples/examples_common.cpp, setDefaultBehavior."""
IMPOSSIBLE: Mapping[Command, Mapping[str, object]] = {
    Command.SET_JOINT_IMPEDANCE: {"K_theta": (-1.0,) * 7},
    Command.SET_CARTESIAN_IMPEDANCE: {"K_x": (1e6,) * 6},
    Command.SET_EE_TO_K: {"EE_T_K": (2.0,) * 16},
    Command.SET_NE_TO_EE: {"NE_T_EE": (nan,) * 16},
    Command.SET_LOAD: {"m_load": -1.0, "I_load": (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)},
}
MODEL = (
    *(f"link[@name='link{i}']" for i in (0, 8)),
    *(f"link[@name='link{i}']/inertial/mass" for i in range(1, 8)),
    *(f"joint[@name='joint{i}']/limit" for i in range(1, 8)),
    *(f"joint[@name='joint{i}']/position_based_velocity_limits" for i in range(1, 8)),
)
"""Elements of a URDF that libfranka reads."""
SETTERS = [command for command in Command if command.name.startswith("SET_")]


def values_of(command: Command, dialog: Dialog) -> Mapping[str, object]:
    """Return values for a setter: the present values, or those of the examples."""
    fields = dialog.protocol.exchanges[command].request.offsets
    if command is Command.SET_FILTERS:
        return dict.fromkeys(fields, 1000.0)
    return POSSIBLE.get(command) or {name: dialog.state[name] for name in fields}


def test_version_is_agreed(row: Row, endpoint: Endpoint) -> Verdict:
    version = endpoint.protocol.version
    row.expected = f"Connect with version {version}: success, version {version}"
    status, newest = ask_version(endpoint.host, endpoint.port, version)
    return (status, newest) == (SUCCESS, version), f"{status}, version {newest}"


@pytest.mark.parametrize("version", [1, 999])
def test_wrong_version_is_refused_with_the_right_one(
    endpoint: Endpoint, version: int
) -> Verdict:
    """The answer is incompatible library version, with a version of the robot."""
    status, newest = ask_version(endpoint.host, endpoint.port, version)
    is_refused = status == "incompatible library version"
    return is_refused and newest in PROTOCOLS, f"{status}, version {newest}"


def test_refused_client_may_connect_again_at_once(endpoint: Endpoint) -> Verdict:
    """A client can connect and gets a state after a refused version."""
    ask_version(endpoint.host, endpoint.port, 999)
    endpoint.open().close()
    return True, "connected"


def test_request_that_tcp_has_cut_is_read(endpoint: Endpoint) -> Verdict:
    """Connect, sent in two pieces, is answered with success."""
    network = open_network(endpoint.host, endpoint.port)
    send = network.send

    def send_in_pieces(data: bytes) -> None:
        send(data[:7])
        network.receive(0.02)
        send(data[7:])

    network.send = send_in_pieces  # type: ignore[method-assign]
    with closing(Dialog(network, endpoint.protocol)):
        return True, "success"


def test_states_have_their_size(row: Row, dialog: Dialog) -> Verdict:
    wanted = dialog.protocol.state.size
    row.expected = f"{wanted} bytes"
    for _ in range(20):
        dialog.next_state()
    seen = ", ".join(f"{size} bytes" for size in sorted(dialog.sizes))
    return dialog.sizes == {wanted}, seen


def test_states_come_from_the_address_of_the_robot(
    row: Row, dialog: Dialog, endpoint: Endpoint
) -> Verdict:
    wanted, sender = gethostbyname(endpoint.host), dialog.network.sender
    row.expected = f"states from {wanted}: firewalls and cautious clients drop others"
    return sender == wanted, f"states from {sender}"


def test_numbers_of_states_rise_by_one(dialog: Dialog) -> Verdict:
    """In 95 of 100 states, message_id is one higher than in the state before."""
    dialog.settle()
    ids = [dialog.next_state()["message_id"] for _ in range(101)]
    steps = [after - before for before, after in pairwise(ids)]
    ones = steps.count(1)
    return ones >= 95, f"{ones} of 100 steps are 1, the largest is {max(steps)}"


def test_idle_arm_shows_its_modes(state: State) -> Verdict:
    """The state has generator 0, controller 3, robot mode 1 (idle) and no error."""
    names = "motion_generator_mode", "controller_mode", "robot_mode"
    shown = [*(state[name] for name in names), sum(state["errors"])]
    seen = "generator {}, controller {}, robot mode {}, {} errors".format(*shown)
    return shown == [NO_GENERATOR, NO_CONTROLLER, RobotMode.IDLE.value, 0], seen


def test_all_numbers_are_finite(state: State) -> Verdict:
    """No field has a NaN or an infinity."""
    wrong = [name for name in state if not np.isfinite(state[name]).all()]
    return not wrong, ", ".join(wrong) or "all finite"


def test_pose_agrees_with_the_joints(state: State) -> Verdict:
    """O_T_EE agrees within 0.01 with the kinematics of q and F_T_EE."""
    pose = frame_pose(Frame.END_EFFECTOR, state["q"], state["F_T_EE"])
    away = farthest(pose, state["O_T_EE"])
    return away < SAME_POSE, f"{away:.2g} away"


def test_end_effector_is_composed_of_its_frames(state: State) -> Verdict:
    """F_T_NE times NE_T_EE is F_T_EE."""
    away = farthest(compose(state["F_T_NE"], state["NE_T_EE"]), state["F_T_EE"])
    return away < 1e-4, f"{away:.2g} away"


def test_joints_rest_where_they_are_desired(state: State) -> Verdict:
    """The positions are within 0.02 rad of q_d, the velocities below 0.05 rad/s."""
    away, fast = farthest(state["q"], state["q_d"]), max(map(abs, state["dq"]))
    return away < 0.02 and fast < 0.05, f"{away:.2g} rad away, {fast:.2g} rad/s"


def test_gravity_is_told(state: State) -> Verdict:
    """O_ddP_O is 9.81 m/s², which the models of clients use as gravity."""
    acceleration = state["O_ddP_O"]
    seen = f"({', '.join(f'{value:.3g}' for value in acceleration)}) m/s²"
    return abs(hypot(*acceleration) - GRAVITY) < 0.2, seen


def test_accelerometers_feel_gravity(state: State) -> Verdict:
    """Each of the twelve boards of an arm at rest measures 9.81 ± 1.5 m/s²."""
    needs("accelerometer_top" in state)
    values = (*state["accelerometer_top"], *state["accelerometer_bottom"])
    felt = [hypot(*values[i : i + 3]) for i in range(0, 36, 3)]
    holds = all(abs(one - GRAVITY) < 1.5 for one in felt)
    return holds, f"{min(felt):.3g} to {max(felt):.3g} m/s²"


def test_load_of_the_end_effector_is_possible(state: State) -> Verdict:
    """Masses are 0 to 10 kg, and no moment of inertia is negative."""
    holds = all(0.0 <= state[mass] < 10.0 for mass in ("m_ee", "m_load")) and all(
        state[i][k] >= 0.0 for i in ("I_ee", "I_load") for k in (0, 4, 8)
    )
    return holds, f"m_ee {state['m_ee']:.3g} kg, m_load {state['m_load']:.3g} kg"


@pytest.mark.parametrize("command", SETTERS, ids=lambda c: c.name.lower())
def test_possible_setting_is_accepted(dialog: Dialog, command: Command) -> Verdict:
    """The answer is success."""
    needs(command in dialog.protocol.exchanges)
    return dialog.expect(command, SUCCESS, **values_of(command, dialog))


@pytest.mark.parametrize("command", IMPOSSIBLE, ids=lambda c: c.name.lower())
def test_impossible_setting_is_refused(dialog: Dialog, command: Command) -> Verdict:
    """The answer is invalid argument rejected."""
    wanted = "invalid argument rejected"
    holds, seen = dialog.expect(command, wanted, **IMPOSSIBLE[command])
    if seen == SUCCESS:  # undo it if possible
        dialog.ask(command, **values_of(command, dialog))
    return holds, seen


def test_virtual_walls_are_told(dialog: Dialog) -> Verdict:
    """The answer is success."""
    needs(Command.GET_CARTESIAN_LIMIT in dialog.protocol.exchanges)
    return dialog.expect(Command.GET_CARTESIAN_LIMIT, SUCCESS, id=0)


def test_stop_of_an_idle_arm_succeeds(dialog: Dialog) -> Verdict:
    """The answer is success."""
    return dialog.expect(Command.STOP_MOVE, SUCCESS)


def test_recovery_without_an_error_succeeds(dialog: Dialog) -> Verdict:
    """The answer is success."""
    return dialog.expect(Command.AUTOMATIC_ERROR_RECOVERY, SUCCESS)


def test_model_library_is_sent(dialog: Dialog) -> Verdict:
    """The answer is success, with an ELF library for x86-64 Linux."""
    needs(Command.LOAD_MODEL_LIBRARY in dialog.protocol.exchanges)
    values = {"architecture": Architecture.X64, "system": System.LINUX}
    answer = dialog.ask(Command.LOAD_MODEL_LIBRARY, **values)
    is_library = answer.rest.startswith(b"\x7fELF")
    seen = f"{answer.words}, {len(answer.rest)} bytes"
    return answer.words == SUCCESS and is_library, seen


def test_robot_model_is_what_libfranka_parses(row: Row, dialog: Dialog) -> Verdict:
    needs(Command.GET_ROBOT_MODEL in dialog.protocol.exchanges)
    row.expected = (
        "a URDF: links link0 to link8, link1 to link7 with masses; joints joint1 to "
        "joint7 with limits, and with position_based_velocity_limits"
    )
    answer = dialog.ask(Command.GET_ROBOT_MODEL)
    row.seen = f"{answer.words}, {len(answer.rest)} bytes"
    if answer.words != SUCCESS:
        return False, row.seen
    robot = ElementTree.fromstring(answer.rest)
    lacks = [part for part in MODEL if robot.find(part) is None]
    missing = ", ".join(lacks) or "nothing"
    return not lacks, f"{len(answer.rest)} bytes; missing: {missing}"


def test_frames_and_load_are_shown_as_they_were_set(dialog: Dialog) -> Verdict:
    """After SetEEToK, EE_T_K of a state is the frame that was set."""
    before = dialog.settle()["EE_T_K"]
    frame = (*IDENTITY[:12], 0.0, 0.0, 0.01, 1.0)
    dialog.ask(Command.SET_EE_TO_K, EE_T_K=frame)
    shown = dialog.wait_until(lambda s: farthest(s["EE_T_K"], frame) < 1e-6, 0.5)
    seen = "it is" if shown else f"EE_T_K {dialog.state['EE_T_K']}"
    dialog.ask(Command.SET_EE_TO_K, EE_T_K=before)
    return shown, seen
