"""Find joint readings that are not finite."""

from math import isfinite

from station.core.franka.franka_robot_state import RobotState


def blind_sensor(state: RobotState) -> str | None:
    """Return the first joint reading that is not finite; None when all are. Cheap.

    Args:
        state: The arm's state.
    """
    if isfinite(sum(state.q) + sum(state.dq) + sum(state.tau_J)):
        return None
    for what, readings in (
        ("position", state.q),
        ("velocity", state.dq),
        ("torque", state.tau_J),
    ):
        for i, value in enumerate(readings):
            if not isfinite(value):
                return f"the {what} of joint{i + 1} reads {value}"
    return None
