"""Checks that move the arm: every mode, the end of a motion, lost commands, rates."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import IntEnum
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
    Verdict,
    words,
)
from station.testing.fci_conformance.plugin import needs
from station.testing.fci_conformance.trajectories import (
    CARTESIAN,
    JOINTS,
    START,
    along,
    distance,
    farthest,
    go_to,
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


def turn(cycle: int) -> float:
    """Return the motion of joint 7 there and back [rad]."""
    return 0.08 * there_and_back(cycle / TIME)


def rise(cycle: int) -> float:
    """Return the motion of the end effector up and down [m]."""
    return 0.02 * there_and_back(cycle / TIME)


MOTIONS: dict[str, Callable[[], Motion]] = {
    "joint position": lambda: joint_positions(along(6, turn)),
    "joint velocity": lambda: joint_velocities(along(6, rate(turn))),
    "cartesian position": lambda: poses(along(2, rise, 3)),
    "cartesian position with an elbow": lambda: poses(
        along(2, rise, 3), elbow=(0.0, 1.0)
    ),
    "cartesian velocity": lambda: twists(along(2, rate(rise), 6)),
}


MEANWHILE: dict[str, tuple[Command, type[IntEnum], Sequence[str]]] = {
    "second motion": (Command.MOVE, MoveStatus, ()),
    "setting": (Command.SET_EE_TO_K, SetterStatus, ("EE_T_K",)),
}
"""Requests that an arm refuses while it moves, with the fields to take from its state.
"""


@pytest.mark.parametrize(
    ("controller", "motion"),
    list(product((JOINTS, CARTESIAN), MOTIONS)),
    ids=lambda one: str(getattr(one, "name", one)).lower().replace("_", " "),
)
def test_motion_there_and_back(
    dialog: Dialog, controller: MoveController, motion: str
) -> Verdict:
    """The motion succeeds without errors, and ends within 0.02 rad of its start."""
    speeds = [0.0]
    asked = replace(MOTIONS[motion](), controller=controller)
    look = asked.watched(lambda _n, state: speeds.extend(map(abs, state["dq_d"])))
    outcome = dialog.move(look, TIME + REST)
    away, fast = distance(outcome, "q", START), max(speeds)
    # The states show the motion: the desired velocities are not zero.
    holds = outcome.is_clean and away < 0.02 and fast > 0.01
    return holds, f"{outcome}; {away:.2g} rad away, dq_d up to {fast:.2g} rad/s"


def test_motion_goes_where_it_is_told(dialog: Dialog) -> Verdict:
    """Joint 7 ends 0.08 rad from its start, within 0.01 rad."""
    motion = joint_positions(along(6, lambda n: 0.08 * smooth(n / TIME)))
    outcome = dialog.move(motion, TIME + REST)
    moved = dialog.settle()["q"][6] - outcome.first["q"][6]
    holds = outcome.is_success and abs(moved - 0.08) < 0.01
    return holds, f"{outcome}; {moved:.4f} rad further"


def test_torques_hold_without_a_generator(dialog: Dialog) -> Verdict:
    """A motion of zero torques succeeds, and the arm stays within 0.2 rad."""
    outcome = dialog.move(torques(), 200)
    away = distance(outcome, "q", START)
    return outcome.is_clean and away < 0.2, f"{outcome}; {away:.2g} rad away"


def test_torques_turn_a_joint(dialog: Dialog) -> Verdict:
    """A torque of 1 Nm turns joint 7 by more than 1 mrad within 0.3 s."""
    motion = torques(along(6, lambda n: min(n, 200, max(0, 400 - n)) / 200))
    outcome = dialog.move(motion, 400)
    moved = outcome.last["q"][6] - outcome.first["q"][6]
    return outcome.is_success and moved > 0.001, f"{outcome}; {moved:.4f} rad"


def test_motion_without_a_generator_is_refused_before_version_7(
    dialog: Dialog,
) -> Verdict:
    """The answer is invalid argument rejected."""
    needs(MoveGenerator.NONE not in dialog.protocol.generators)
    _, answer = dialog.start(replace(torques(), generator=MoveGenerator.NONE))
    wanted = MoveStatus.INVALID_ARGUMENT_REJECTED
    return answer.status == wanted, words(MoveStatus, answer.status)


def test_arm_waits_for_the_first_command(dialog: Dialog) -> Verdict:
    """After 100 ms without a command the mode is move, and then the motion succeeds."""
    modes: set[int] = set()
    motion = hold().without(lambda n: n < 100)
    motion = motion.watched(lambda _n, state: modes.add(state["robot_mode"]))
    outcome = dialog.move(motion, 200)
    holds = outcome.is_success and modes == {RobotMode.MOVE.value}
    return holds, f"{outcome}; modes {sorted(modes)}"


@pytest.mark.parametrize("asked", MEANWHILE)
def test_request_during_a_motion_is_refused(dialog: Dialog, asked: str) -> Verdict:
    """The answer is command not possible rejected, and the motion succeeds."""
    command, statuses, fields = MEANWHILE[asked]
    values = {name: dialog.state[name] for name in fields}
    outcome, told = ask_meanwhile(dialog, command, statuses, values)
    holds = outcome.is_success and told == "command not possible rejected"
    return holds, f"{told}; the motion: {outcome}"


def test_stop_preempts_a_motion(dialog: Dialog) -> Verdict:
    """Move is answered with preempted, StopMove with success, and the arm is idle."""
    outcome, told = ask_meanwhile(dialog, Command.STOP_MOVE, StopMoveStatus, {})
    is_over = outcome.ended == MoveStatus.PREEMPTED and told == "success"
    mode = dialog.state["robot_mode"]
    seen = f"Move {outcome}, StopMove {told}, robot mode {mode}"
    return is_over and mode == RobotMode.IDLE.value, seen


def ask_meanwhile(
    dialog: Dialog, command: Command, statuses: type[IntEnum], values: Fields
) -> tuple[Outcome, str]:
    """Send a request during a motion; return the motion's course, and the answer."""
    sent: list[int] = []

    def ask(cycle: int, _state: State) -> None:
        if cycle >= 100 and not sent:
            sent.append(dialog.client.send(command, values))

    outcome = dialog.move(hold().watched(ask), 300)
    answer = dialog.client.take_answer(sent[0], 1.0) if sent else None
    return outcome, "no answer" if answer is None else words(statuses, answer.status)


def test_success_rate_counts_the_commands_that_came(dialog: Dialog) -> Verdict:
    """The rate is the answered share of the last 100 states: all, or two of three."""
    whole, partly = hold(), hold().without(lambda n: n >= 50 and n % 3 == 0)
    off = [0.0]
    outcomes = [dialog.move(counted(motion, off), 310) for motion in (whole, partly)]
    rates = ", ".join(f"{one.lowest_rate:.2f} ({one})" for one in outcomes)
    holds = all(one.is_success for one in outcomes) and max(off) < 0.05
    return holds, f"{rates}; up to {max(off):.2f} from what was sent"


def counted(motion: Motion, off: list[float]) -> Motion:
    """Return a motion that compares the success rate with a count of its own."""
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


def test_some_lost_commands_in_a_row_are_no_error(dialog: Dialog) -> Verdict:
    """The motion succeeds although 15 commands in a row are left out."""
    outcome = dialog.move(hold().without(lambda n: 100 <= n < 115), 300)
    return outcome.is_clean, outcome


def test_hole_in_a_moving_joint_is_bridged(dialog: Dialog) -> Verdict:
    """The motion succeeds although 2 commands of a moving joint are left out."""
    motion, hole = MOTIONS["joint position"](), TIME // 4
    outcome = dialog.move(motion.without(lambda n: 0 <= n - hole < 2), TIME + REST)
    return outcome.is_success, outcome


def test_errors_of_the_last_motion_are_forgotten_by_the_next(
    dialog: Dialog,
) -> Verdict:
    """After a motion without errors, last_motion_errors is empty."""
    dialog.move(joint_positions(along(6, step(0.5))), 100)
    go_to(dialog)
    outcome = dialog.move(hold(), 100)
    return outcome.is_clean, outcome


def test_asynchronous_positions(dialog: Dialog) -> Verdict:
    """q_d reaches one goal 0.1 rad away within 1 mrad, and the motion succeeds."""
    fields = dialog.protocol.exchanges[Command.MOVE].request.offsets
    needs("use_async_motion_generator" in fields)
    goal = [q + 0.1 * (i == 6) for i, q in enumerate(START)]
    reached: list[int] = []

    def stream(cycle: int, state: State) -> Fields | None:
        if cycle <= 10:
            return {"q_c": goal} if cycle == 10 else None
        away = farthest(state["q_d"], goal)
        if away < 1e-3 and max(map(abs, state["dq_d"])) < 0.01:
            reached.append(cycle)
        if cycle < 3000 and not reached:
            return None
        return {"q_c": [0.0] * 7, "motion_generation_finished": True}

    asked = {"use_async_motion_generator": True, "maximum_velocity": (0.5,) * 7}
    outcome = dialog.move(replace(hold(), stream=stream), 3000, **asked)
    when = f"after {reached[0]} ms" if reached else "never"
    return bool(reached) and outcome.is_success, f"{outcome}; reached {when}"
