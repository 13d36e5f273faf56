"""The poses and the motions from which the checks that move an arm begin and end."""

from collections.abc import Sequence
from math import inf, pi, sqrt

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveStatus,
    RecoveryStatus,
)
from station.testing.fci_conformance.dialog import (
    LONGEST_END,
    Dialog,
    FciSilenceError,
    Outcome,
    words,
)
from station.testing.fci_conformance.trajectories import joint_positions, smooth

START = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""The pose at which the checks begin [rad]; libfranka's examples begin there."""
_SPEED = (1.0, 1.0, 1.0, 1.0, 1.6, 1.6, 1.6)  # [rad/s]
_ACCELERATION = 5.0  # [rad/s^2]
_SHORTEST = 0.2  # [s]
_THERE = 0.02
_STILL = 1e-3  # [rad/s]


def recover(dialog: Dialog) -> str:
    """Recover once, and return the answer in words; `idle` if the arm is idle then.

    Raises:
        FciNetworkError: No answer comes.
    """
    number = dialog.client.send(Command.AUTOMATIC_ERROR_RECOVERY)
    answer = dialog.client.take_answer(number, LONGEST_END)
    if answer is None:
        return f"no answer within {LONGEST_END:g} s"
    if answer.status != RecoveryStatus.SUCCESS:
        return words(RecoveryStatus, answer.status)
    if not dialog.wait_until(lambda s: s["robot_mode"] == RobotMode.IDLE.value, 1.0):
        return f"success, and robot mode {dialog.state['robot_mode']}"
    if any(dialog.state["errors"]):
        return "success, and the errors are still there"
    return "idle"


def go_to(dialog: Dialog, q: Sequence[float] = START) -> None:
    """Move the joints slowly to a pose, out of a reflex if need be.

    Raises:
        FciNetworkError: The endpoint does not answer.
        FciSilenceError: The arm does not arrive.
    """
    state = dialog.settle()
    if state["robot_mode"] != RobotMode.IDLE.value:
        recover(dialog)
    # The last motion may have left the arm slowing down.
    dialog.wait_until(lambda s: max(map(abs, s["dq_d"])) < _STILL, 1.0)
    state = dialog.state
    way = [goal - now for goal, now in zip(q, state["q_d"], strict=True)]
    farthest = max(map(abs, way))
    if farthest < 1e-3:
        return
    # Of the way of `smooth`: velocity and acceleration are this much above the mean.
    slow = max(1.875 * abs(a) / v for a, v in zip(way, _SPEED, strict=True))
    seconds = max(_SHORTEST, slow, sqrt(5.7735 * farthest / _ACCELERATION))
    cycles = round(1000.0 * seconds)
    motion = joint_positions(lambda n: [smooth(n / cycles) * one for one in way])
    outcome = dialog.move(motion, cycles + 20)
    away = distance(outcome, "q", q) if outcome.ended is not None else inf
    if outcome.ended != MoveStatus.SUCCESS or away > _THERE:
        raise FciSilenceError(
            f"on the way to the pose of the check: {outcome}, {away:.3f} rad off it"
        )


def distance(outcome: Outcome, field: str, wanted: Sequence[float]) -> float:
    """Return the largest difference of a field's last value from the wanted one."""
    last: Sequence[float] = outcome.last[field]
    return max(abs(a - b) for a, b in zip(last, wanted, strict=True))
