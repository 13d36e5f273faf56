"""The poses and the motions from which the checks that move an arm begin and end."""

from collections.abc import Sequence
from math import pi

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.wire.robot_protocol import (
    Command,
    MoveController,
    MoveGenerator,
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

JOINTS = MoveController.JOINT_IMPEDANCE
CARTESIAN = MoveController.CARTESIAN_IMPEDANCE
EXTERNAL = MoveController.EXTERNAL_CONTROLLER
POSITION, VELOCITY = MoveGenerator.JOINT_POSITION, MoveGenerator.JOINT_VELOCITY
POSE, TWIST = MoveGenerator.CARTESIAN_POSITION, MoveGenerator.CARTESIAN_VELOCITY

START = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""The pose at which the checks begin [rad]; libfranka's examples begin there."""
_SPEED = 0.6
_SHORTEST = 0.5
_THERE = 0.02
_TRIES = 3


def torque_generator(dialog: Dialog) -> MoveGenerator:
    """Return the generator with which torques alone are commanded in a version."""
    generators = dialog.protocol.generators
    return MoveGenerator.NONE if MoveGenerator.NONE in generators else VELOCITY


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
    # The way is not the check: a client that a busy machine has made late tries again.
    problem: str | None = ""
    for _ in range(_TRIES):
        problem = _try_to_go_to(dialog, q)
        if problem is None:
            return
    raise FciSilenceError(f"on the way to the pose of the check: {problem}")


def _try_to_go_to(dialog: Dialog, q: Sequence[float]) -> str | None:
    """Move to a pose; return why the arm has not arrived, None if it has."""
    state = dialog.settle()
    if state["robot_mode"] != RobotMode.IDLE.value:
        recover(dialog)
        state = dialog.settle()
    way = [goal - now for goal, now in zip(q, state["q_d"], strict=True)]
    farthest = max(map(abs, way))
    if farthest < 1e-3:
        return None
    cycles = round(1000.0 * max(_SHORTEST, 1.875 * farthest / _SPEED))
    stream = joint_positions(lambda n: [smooth(n / cycles) * one for one in way])
    outcome = dialog.move(JOINTS, POSITION, stream, cycles + 20)
    if outcome.ended != MoveStatus.SUCCESS:
        return str(outcome)
    away = max(abs(a - b) for a, b in zip(dialog.state["q"], q, strict=True))
    return None if away < _THERE else f"the arm stands {away:.3f} rad off it"


def distance(outcome: Outcome, field: str, wanted: Sequence[float]) -> float:
    """Return the largest difference of a field's last value from the wanted one."""
    last: Sequence[float] = outcome.last[field]
    return max(abs(a - b) for a, b in zip(last, wanted, strict=True))
