"""The meaning of the arm's answers, in libfranka's words.

Source: libfranka@0.9.2 src/robot_impl.h, handleCommandResponse; differs: there are
remedies as well.
"""

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.fci.driver.fci_client import RobotAnswer
from station.hw.franka.fci.wire.robot_protocol import Command, Status

_WORDS = {
    Status.PREEMPTED: "preempted!",
    Status.START_AT_SINGULAR_POSE_REJECTED: "rejected: cannot start at singular pose!",
    Status.INVALID_ARGUMENT_REJECTED: "rejected: invalid argument!",
    Status.REFLEX_ABORTED: "aborted: motion aborted by reflex!",
    Status.EMERGENCY_ABORTED: "aborted: User Stop pressed!",
    Status.INPUT_ERROR_ABORTED: "aborted: invalid input provided!",
    Status.MANUAL_ERROR_RECOVERY_REQUIRED_REJECTED: (
        "rejected: manual error recovery required!"
    ),
    Status.ABORTED: "aborted!",
    Status.PREEMPTED_BY_SAFETY: "preempted due to activated safety function!",
    Status.REJECTED_BY_SAFETY: "rejected due to activated safety function!",
}
_WRONG_MOVE = Command.MOVE, Status.INVALID_ARGUMENT_REJECTED
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
    name = answer.command.name.replace("_", " ").title()
    # Names of frames keep their capitals: "Set NE to EE".
    name = name.replace("Ne ", "NE ").replace("Ee", "EE").replace(" To ", " to ")
    words = _WORDS.get(answer.status)
    if answer.status is Status.COMMAND_NOT_POSSIBLE_REJECTED:
        shown = mode.name.replace("_", " ").capitalize()
        brakes = " Did you open the brakes?" if mode is RobotMode.OTHER else ""
        words = (
            f'rejected: command not possible in the current mode ("{shown}")!{brakes}'
        )
    elif (answer.command, answer.status) == _WRONG_MOVE:
        words = "rejected: maximum path deviation out of range!"
    if words is None:
        return f"libfranka: Unexpected response while handling {name} command!"
    return f"libfranka: {name} command {words}"
