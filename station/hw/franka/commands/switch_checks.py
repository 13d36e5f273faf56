"""Why controllers cannot take an arm now, whatever they command."""

from station.core.errors import SwitchRefusedError


def check_free(
    arm_id: str, *, is_connected: bool, has_guest: bool, blindness: str | None
) -> None:
    """Refuse to start controllers of an arm that is not free for them.

    Args:
        arm_id: Name of the arm.
        is_connected: Whether the arm is connected.
        has_guest: Whether a client of the Franka Control Interface moves the arm.
        blindness: Which reading is not finite; None when all are.

    Raises:
        SwitchRefusedError: The arm is not free.
    """
    if not is_connected:
        raise SwitchRefusedError(
            f"Arm '{arm_id}' is not connected.", remedy="Connect the arm first."
        )
    if has_guest:
        raise SwitchRefusedError(
            f"A client of the Franka Control Interface moves arm '{arm_id}'.",
            remedy="Let the client end its motion first.",
        )
    if blindness is not None:
        raise SwitchRefusedError(
            f"Arm '{arm_id}' is blind: {blindness}.",
            remedy="Wait until the sensor reads finite numbers again.",
        )
