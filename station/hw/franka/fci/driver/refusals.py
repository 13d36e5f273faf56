"""The meaning of the arm's answers, in libfranka's words.

Source: libfranka@0.9.2 src/robot_impl.h, handleCommandResponse; differs: there are
remedies as well.
"""

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.driver.fci_client import RobotAnswer
from station.hw.franka.fci.wire.robot_protocol import Command

_WORDS = {
    "PREEMPTED": "command preempted!",
    "START_AT_SINGULAR_POSE_REJECTED": (
        "command rejected: cannot start at singular pose!"
    ),
    "INVALID_ARGUMENT_REJECTED": "command rejected: invalid argument!",
    "REFLEX_ABORTED": "command aborted: motion aborted by reflex!",
    "EMERGENCY_ABORTED": "command aborted: User Stop pressed!",
    "INPUT_ERROR_ABORTED": "command aborted: invalid input provided!",
    "MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED": (
        "command rejected: manual error recovery required!"
    ),
    "ABORTED": "command aborted!",
    "PREEMPTED_BY_SAFETY": "command preempted due to activated safety function!",
    "REJECTED_BY_SAFETY": "command rejected due to activated safety function!",
}
_WORDS_OF_MOVE = {
    "INVALID_ARGUMENT_REJECTED": (
        "command rejected: maximum path deviation out of range!"
    ),
}
REMEDIES = {
    RobotMode.OTHER: "open the brakes and activate FCI in Desk",
    RobotMode.GUIDING: "let go of the guiding buttons",
    RobotMode.REFLEX: "remove the cause, then recover",
    RobotMode.USER_STOPPED: "release the user stop",
    RobotMode.AUTOMATIC_ERROR_RECOVERY: "wait until the arm is at rest",
}
"""Remedy for each mode in which an arm cannot move."""


def refusal_of(answer: RobotAnswer, mode: RobotMode) -> str:
    """Return libfranka's message for an answer that is not a success.

    Args:
        answer: The answer.
        mode: The arm's mode.
    """
    status, command = answer.status.name, answer.command
    name = command.name.replace("_", " ").title()
    # Names of frames keep their capitals: "Set NE to EE".
    name = name.replace("Ne ", "NE ").replace("Ee", "EE").replace(" To ", " to ")
    if status == "COMMAND_NOT_POSSIBLE_REJECTED":
        shown = mode.name.replace("_", " ").capitalize()
        brakes = " Did you open the brakes?" if mode is RobotMode.OTHER else ""
        return (
            f"libfranka: {name} command rejected: command not possible in the current "
            f'mode ("{shown}")!{brakes}'
        )
    words = _WORDS | _WORDS_OF_MOVE if command is Command.MOVE else _WORDS
    if status not in words:
        return f"libfranka: Unexpected response while handling {name} command!"
    return f"libfranka: {name} {words[status]}"
