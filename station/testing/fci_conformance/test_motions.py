"""Checks that move: every mode, the end of a motion, lost commands, the rate."""

from collections.abc import Callable
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
    State,
    Stream,
    words,
)
from station.testing.fci_conformance.moving import (
    CARTESIAN,
    EXTERNAL,
    JOINTS,
    POSE,
    POSITION,
    START,
    TWIST,
    VELOCITY,
    distance,
    go_to,
    torque_generator,
)
from station.testing.fci_conformance.plugin import Row
from station.testing.fci_conformance.trajectories import (
    CYCLE,
    along,
    joint_positions,
    joint_velocities,
    one_joint,
    poses,
    smooth,
    there_and_back,
    torques,
    twists,
)

pytestmark = pytest.mark.moves

TIME = 1000
"""Cycles of a motion there and back."""
ANGLE, WAY = 0.08, 0.02
"""How far the joint 7 turns [rad], and the end effector goes up [m]."""
END = 0.02
"""Largest distance of a joint from where the motion has to end [rad]."""
REST = 30


def rate(part: Callable[[float], float], n: int) -> float:
    """Return the velocity of a way from one cycle to the next, per second."""
    return (part(n / TIME) - part((n - 1) / TIME)) / CYCLE if n else 0.0


def hold() -> Stream:
    """Return a stream that stays at the first position."""
    return joint_positions(lambda _n: [0.0] * 7)


MOTIONS: dict[MoveGenerator, Callable[[], Stream]] = {
    POSITION: lambda: joint_positions(
        lambda n: one_joint(6, ANGLE * there_and_back(n / TIME))
    ),
    VELOCITY: lambda: joint_velocities(
        lambda n: one_joint(6, ANGLE * rate(there_and_back, n))
    ),
    POSE: lambda: poses(lambda n: along(2, WAY * there_and_back(n / TIME))),
    TWIST: lambda: twists(lambda n: along(2, WAY * rate(there_and_back, n), 6)),
}


def name(value: object) -> str:
    """Return the name of a mode, in words."""
    return str(getattr(value, "name", value)).lower().replace("_", " ")


@pytest.mark.parametrize(
    ("controller", "generator"), list(product((JOINTS, CARTESIAN), MOTIONS)), ids=name
)
def test_motion_there_and_back(
    row: Row, dialog: Dialog, controller: MoveController, generator: MoveGenerator
) -> None:
    row.expect(f"success, no error, joints within {END:g} rad of where they began")
    go_to(dialog)
    stream, moved = MOTIONS[generator](), [0.0]

    def watch(cycle: int, state: State) -> Fields | None:
        moved[0] = max(moved[0], *map(abs, state["dq_d"]))
        return stream(cycle, state)

    outcome = dialog.move(controller, generator, watch, TIME + REST)
    away = distance(outcome, "q", START)
    row.see(f"{outcome}; {away:.2g} rad away, dq_d up to {moved[0]:.2g} rad/s")
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors
    assert away < END
    assert moved[0] > 0.01  # the states show the motion


def test_motion_goes_where_it_is_told(row: Row, dialog: Dialog) -> None:
    row.expect(f"joint 7 ends {ANGLE:g} rad further, within 0.01 rad")
    go_to(dialog)
    stream = joint_positions(lambda n: one_joint(6, ANGLE * smooth(n / TIME)))
    outcome = dialog.move(JOINTS, POSITION, stream, TIME + REST)
    moved = dialog.settle()["q"][6] - outcome.first["q"][6]
    row.see(f"{outcome}; {moved:.4f} rad further")
    assert outcome.ended == MoveStatus.SUCCESS
    assert abs(moved - ANGLE) < 0.01


def test_torques_hold_without_a_generator(row: Row, dialog: Dialog) -> None:
    row.expect("success of zero torques, the arm floats within 0.2 rad")
    go_to(dialog)
    generator = torque_generator(dialog)
    outcome = dialog.move(EXTERNAL, generator, torques(lambda _n: 0.0), 200)
    row.see(f"{outcome}; {distance(outcome, 'q', START):.2g} rad away")
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors
    assert distance(outcome, "q", START) < 0.2


def test_torques_turn_a_joint(row: Row, dialog: Dialog) -> None:
    row.expect("joint 7 turns by more than 1 mrad under 1 Nm within 0.3 s")
    go_to(dialog)
    stream = torques(lambda n: min(n, 200, max(0, 400 - n)) / 200)
    outcome = dialog.move(EXTERNAL, torque_generator(dialog), stream, 400)
    moved = outcome.last["q"][6] - outcome.first["q"][6]
    row.see(f"{outcome}; {moved:.4f} rad")
    assert outcome.ended == MoveStatus.SUCCESS
    assert moved > 0.001


def test_motion_without_a_generator_is_refused_before_version_7(
    row: Row, dialog: Dialog
) -> None:
    if MoveGenerator.NONE in dialog.protocol.generators:
        row.leave_out()
    row.expect("invalid argument rejected")
    go_to(dialog)
    _, answer = dialog.start(EXTERNAL, MoveGenerator.NONE)
    row.see(words(MoveStatus, answer.status))
    assert answer.status == MoveStatus.INVALID_ARGUMENT_REJECTED


def test_arm_waits_for_the_first_command(row: Row, dialog: Dialog) -> None:
    row.expect("mode move after 100 ms without a first command, then success")
    go_to(dialog)
    stay, modes = hold(), []

    def stream(cycle: int, state: State) -> Fields | None:
        modes.append(state["robot_mode"])
        return None if cycle < 100 else stay(cycle, state)

    outcome = dialog.move(JOINTS, POSITION, stream, 200)
    row.see(f"{outcome}; modes {sorted(set(modes))}")
    assert outcome.ended == MoveStatus.SUCCESS
    assert set(modes) == {RobotMode.MOVE.value}


def test_stop_preempts_a_motion(row: Row, dialog: Dialog) -> None:
    row.expect("Move preempted, StopMove success, idle")
    go_to(dialog)
    stream = hold()
    stops: list[int] = []

    def stop(cycle: int, state: State) -> Fields | None:
        if cycle >= 100 and not stops:
            stops.append(dialog.client.send(Command.STOP_MOVE))
        return stream(cycle, state)

    outcome = dialog.move(JOINTS, POSITION, stop, 1000)
    answer = dialog.client.take_answer(stops[0], 1.0) if stops else None
    told = "no answer" if answer is None else words(StopMoveStatus, answer.status)
    row.see(f"Move {outcome}, StopMove {told}, robot mode {dialog.state['robot_mode']}")
    assert outcome.ended == MoveStatus.PREEMPTED
    assert told == "success"
    assert dialog.state["robot_mode"] == RobotMode.IDLE.value


@pytest.mark.parametrize("asked", ["second motion", "setting"])
def test_request_during_a_motion_is_refused(
    row: Row, dialog: Dialog, asked: str
) -> None:
    row.expect("command not possible rejected, and the motion goes on to success")
    go_to(dialog)
    stream = hold()
    sent: list[int] = []

    def ask(cycle: int, state: State) -> Fields | None:
        if cycle >= 100 and not sent:
            frame = {"EE_T_K": state["EE_T_K"]}
            sent.append(
                dialog.client.send(Command.SET_EE_TO_K, frame)
                if asked == "setting"
                else dialog.client.send(
                    Command.MOVE,
                    {"controller_mode": JOINTS, "motion_generator_mode": POSITION},
                )
            )
        return stream(cycle, state)

    outcome = dialog.move(JOINTS, POSITION, ask, 300)
    answer = dialog.client.take_answer(sent[0], 1.0)
    statuses = SetterStatus if asked == "setting" else MoveStatus
    told = "no answer" if answer is None else words(statuses, answer.status)
    row.see(f"{told}; the motion: {outcome}")
    assert told == "command not possible rejected"
    assert outcome.ended == MoveStatus.SUCCESS


def test_success_rate_counts_the_commands_that_came(row: Row, dialog: Dialog) -> None:
    row.expect("above 0.95 with all commands, 0.5 to 0.8 when every third is left out")
    go_to(dialog)
    whole = dialog.move(JOINTS, POSITION, hold(), 300)
    stay = hold()
    partly = dialog.move(
        JOINTS, POSITION, lambda n, s: stay(n, s) if n < 50 or n % 3 else None, 400
    )
    rates = whole.lowest_rate, partly.lowest_rate
    row.see(f"{rates[0]:.2f} ({whole}), {rates[1]:.2f} ({partly})")
    assert rates[0] > 0.95
    assert 0.5 < rates[1] < 0.8
    assert partly.ended == MoveStatus.SUCCESS


def test_some_lost_commands_in_a_row_are_no_error(row: Row, dialog: Dialog) -> None:
    row.expect("success though 15 commands in a row are left out")
    go_to(dialog)
    stay = hold()
    outcome = dialog.move(
        JOINTS, POSITION, lambda n, s: None if 100 <= n < 115 else stay(n, s), 300
    )
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors


def test_hole_in_a_moving_joint_is_bridged(row: Row, dialog: Dialog) -> None:
    row.expect("success though 2 commands of a moving joint are left out")
    go_to(dialog)
    stream = MOTIONS[POSITION]()
    outcome = dialog.move(
        JOINTS,
        POSITION,
        lambda n, s: None if n in (250, 251) else stream(n, s),
        TIME + REST,
    )
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS


def test_errors_of_the_last_motion_are_forgotten_by_the_next(
    row: Row, dialog: Dialog
) -> None:
    row.expect("no last_motion_errors after a motion without errors")
    go_to(dialog)
    jump = joint_positions(lambda n: one_joint(6, 0.5 if n > 50 else 0.0))
    dialog.move(JOINTS, POSITION, jump, 100)
    go_to(dialog)
    outcome = dialog.move(JOINTS, POSITION, hold(), 100)
    row.see(outcome)
    assert outcome.ended == MoveStatus.SUCCESS
    assert not outcome.errors


def test_asynchronous_positions(row: Row, dialog: Dialog) -> None:
    fields = dialog.protocol.exchanges[Command.MOVE].request.offsets
    if "use_async_motion_generator" not in fields:
        row.leave_out()
    row.expect("one command with a goal 0.1 rad away: q_d arrives within 1 mrad, ends")
    go_to(dialog)
    goal = [q + 0.1 * (i == 6) for i, q in enumerate(START)]
    reached = []

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
        JOINTS,
        POSITION,
        stream,
        3000,
        use_async_motion_generator=True,
        maximum_velocity=(0.5,) * 7,
    )
    row.see(f"{outcome}; reached {f'after {reached[0]} ms' if reached else 'never'}")
    assert reached
    assert outcome.ended == MoveStatus.SUCCESS
