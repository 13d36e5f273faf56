"""Checks that move: every mode, the end of a motion, lost commands, the rate."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import pytest

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveController,
    MoveGenerator,
    MoveStatus,
    SetterStatus,
    StopMoveStatus,
)
from station.testing.fci_conformance.dialog import (
    Dialog,
    Fields,
    Motion,
    Outcome,
    State,
    words,
)
from station.testing.fci_conformance.moving import START, distance, go_to
from station.testing.fci_conformance.plugin import Row
from station.testing.fci_conformance.trajectories import (
    CARTESIAN,
    JOINTS,
    along,
    hold,
    joint_positions,
    joint_velocities,
    poses,
    rate,
    smooth,
    step,
    there_and_back,
    torques,
    twists,
)

pytestmark = pytest.mark.moves

TIME = 600
"""Cycles of a motion there and back."""
REST = 30
NO_ANSWER = -1


def turn(cycle: int) -> float:
    """Return the way of joint 7 there and back [rad]."""
    return 0.08 * there_and_back(cycle / TIME)


def rise(cycle: int) -> float:
    """Return the way of the end effector up and down [m]."""
    return 0.02 * there_and_back(cycle / TIME)


MOTIONS: dict[str, Callable[[], Motion]] = {
    "joint position": lambda: joint_positions(along(6, turn)),
    "joint velocity": lambda: joint_velocities(along(6, rate(turn))),
    "cartesian position": lambda: poses(along(2, rise, 3)),
    "cartesian velocity": lambda: twists(along(2, rate(rise), 6)),
}


@pytest.mark.parametrize(
    ("controller", "motion"),
    list(product((JOINTS, CARTESIAN), MOTIONS)),
    ids=lambda one: str(getattr(one, "name", one)).lower().replace("_", " "),
)
def test_motion_there_and_back(
    row: Row, dialog: Dialog, controller: MoveController, motion: str
) -> None:
    """Success, no error, joints within 0.02 rad of where they began."""
    moved = [0.0]

    def look(_cycle: int, state: State) -> None:
        moved[0] = max(moved[0], *map(abs, state["dq_d"]))

    asked = replace(MOTIONS[motion]().watched(look), controller=controller)
    outcome = dialog.move(asked, TIME + REST)
    away = distance(outcome, "q", START)
    row.see(f"{outcome}; {away:.2g} rad away, dq_d up to {moved[0]:.2g} rad/s")
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors
    assert away < 0.02
    assert moved[0] > 0.01  # the states show the motion


def test_motion_goes_where_it_is_told(row: Row, dialog: Dialog) -> None:
    """Joint 7 ends 0.08 rad further, within 0.01 rad."""
    motion = joint_positions(along(6, lambda n: 0.08 * smooth(n / TIME)))
    outcome = dialog.move(motion, TIME + REST)
    moved = dialog.settle()["q"][6] - outcome.first["q"][6]
    row.see(f"{outcome}; {moved:.4f} rad further")
    assert outcome.ended == MoveStatus.SUCCESS
    assert abs(moved - 0.08) < 0.01


def test_torques_hold_without_a_generator(row: Row, dialog: Dialog) -> None:
    """Success of zero torques, the arm floats within 0.2 rad."""
    outcome = dialog.move(torques(), 200)
    row.see(f"{outcome}; {distance(outcome, 'q', START):.2g} rad away")
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors
    assert distance(outcome, "q", START) < 0.2


def test_torques_turn_a_joint(row: Row, dialog: Dialog) -> None:
    """Joint 7 turns by more than 1 mrad under 1 Nm within 0.3 s."""
    motion = torques(along(6, lambda n: min(n, 200, max(0, 400 - n)) / 200))
    outcome = dialog.move(motion, 400)
    moved = outcome.last["q"][6] - outcome.first["q"][6]
    row.see(f"{outcome}; {moved:.4f} rad")
    assert outcome.ended == MoveStatus.SUCCESS
    assert moved > 0.001


def test_motion_without_a_generator_is_refused_before_version_7(
    row: Row, dialog: Dialog
) -> None:
    """Invalid argument rejected."""
    row.needs(MoveGenerator.NONE not in dialog.protocol.generators)
    _, answer = dialog.start(replace(torques(), generator=MoveGenerator.NONE))
    row.see(words(MoveStatus, answer.status))
    assert answer.status == MoveStatus.INVALID_ARGUMENT_REJECTED


def test_arm_waits_for_the_first_command(row: Row, dialog: Dialog) -> None:
    """Mode move after 100 ms without a first command, then success."""
    modes = []
    motion = hold().without(lambda n: n < 100)
    motion = motion.watched(lambda _n, state: modes.append(state["robot_mode"]))
    outcome = dialog.move(motion, 200)
    row.see(f"{outcome}; modes {sorted(set(modes))}")
    assert outcome.ended == MoveStatus.SUCCESS
    assert set(modes) == {RobotMode.MOVE.value}


@pytest.mark.parametrize("asked", ["second motion", "setting"])
def test_request_during_a_motion_is_refused(
    row: Row, dialog: Dialog, asked: str
) -> None:
    """Command not possible rejected, and the motion goes on to success."""
    if asked == "setting":
        command, values = Command.SET_EE_TO_K, {"EE_T_K": dialog.state["EE_T_K"]}
    else:
        command, values = Command.MOVE, {"controller_mode": JOINTS}
    outcome, status = ask_meanwhile(dialog, command, values)
    statuses = SetterStatus if asked == "setting" else MoveStatus
    row.see(f"{words(statuses, status)}; the motion: {outcome}")
    assert words(statuses, status) == "command not possible rejected"
    assert outcome.ended == MoveStatus.SUCCESS


def test_stop_preempts_a_motion(row: Row, dialog: Dialog) -> None:
    """Move preempted, StopMove success, idle."""
    outcome, status = ask_meanwhile(dialog, Command.STOP_MOVE, {})
    told, mode = words(StopMoveStatus, status), dialog.state["robot_mode"]
    row.see(f"Move {outcome}, StopMove {told}, robot mode {mode}")
    assert outcome.ended == MoveStatus.PREEMPTED
    assert status == StopMoveStatus.SUCCESS
    assert mode == RobotMode.IDLE.value


def ask_meanwhile(
    dialog: Dialog, command: Command, values: dict[str, object]
) -> tuple[Outcome, int]:
    """Ask once while a motion runs; return its course, and the status of the answer."""
    sent: list[int] = []

    def ask(cycle: int, _state: State) -> None:
        if cycle >= 100 and not sent:
            sent.append(dialog.client.send(command, values))

    outcome = dialog.move(hold().watched(ask), 300)
    answer = dialog.client.take_answer(sent[0], 1.0) if sent else None
    return outcome, NO_ANSWER if answer is None else answer.status


def test_success_rate_counts_the_commands_that_came(row: Row, dialog: Dialog) -> None:
    """The part of the last 100 states that were answered, all and two of three."""
    whole, partly = hold(), hold().without(lambda n: n >= 50 and n % 3 == 0)
    seen, off = [], [0.0]
    for motion in (whole, partly):
        outcome = dialog.move(counted(motion, off), 310)
        seen.append(f"{outcome.lowest_rate:.2f} ({outcome})")
        assert outcome.ended == MoveStatus.SUCCESS
    row.see(f"{', '.join(seen)}; up to {max(off):.2f} from what was sent")
    assert max(off) < 0.05


def counted(motion: Motion, off: list[float]) -> Motion:
    """Return a motion that notes how far the success rate is from its own count."""
    came: list[int] = []

    def stream(cycle: int, state: State) -> Fields | None:
        if cycle > 150:
            part = sum(n >= cycle - 100 for n in came) / 100
            off.append(abs(state["control_command_success_rate"] - part))
        values = motion.stream(cycle, state)
        if values is not None:
            came.append(cycle)
        return values

    return replace(motion, stream=stream)


def test_some_lost_commands_in_a_row_are_no_error(row: Row, dialog: Dialog) -> None:
    """Success though 15 commands in a row are left out."""
    outcome = dialog.move(hold().without(lambda n: 100 <= n < 115), 300)
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors


def test_hole_in_a_moving_joint_is_bridged(row: Row, dialog: Dialog) -> None:
    """Success though 2 commands of a moving joint are left out."""
    motion = MOTIONS["joint position"]()
    hole = TIME // 4
    outcome = dialog.move(motion.without(lambda n: 0 <= n - hole < 2), TIME + REST)
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS


def test_errors_of_the_last_motion_are_forgotten_by_the_next(
    row: Row, dialog: Dialog
) -> None:
    """No last_motion_errors after a motion without errors."""
    dialog.move(joint_positions(along(6, step(0.5))), 100)
    go_to(dialog)
    outcome = dialog.move(hold(), 100)
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors


def test_asynchronous_positions(row: Row, dialog: Dialog) -> None:
    """One command with a goal 0.1 rad away: q_d arrives within 1 mrad, success."""
    fields = dialog.protocol.exchanges[Command.MOVE].request.offsets
    row.needs("use_async_motion_generator" in fields)
    goal = [q + 0.1 * (i == 6) for i, q in enumerate(START)]
    reached: list[int] = []

    def stream(cycle: int, state: State) -> Fields | None:
        if cycle <= 10:
            return {"q_c": goal} if cycle == 10 else None
        away = max(abs(a - b) for a, b in zip(state["q_d"], goal, strict=True))
        if away < 1e-3 and max(map(abs, state["dq_d"])) < 0.01:
            reached.append(cycle)
        if cycle < 3000 and not reached:
            return None
        return {"q_c": [0.0] * 7, "motion_generation_finished": True}

    outcome = dialog.move(
        replace(hold(), stream=stream),
        3000,
        use_async_motion_generator=True,
        maximum_velocity=(0.5,) * 7,
    )
    row.see(f"{outcome}; reached {f'after {reached[0]} ms' if reached else 'never'}")
    assert reached
    assert outcome.ended == MoveStatus.SUCCESS
