"""Which periods of a control loop an arm can live with."""

import logging

from station.core.errors import HardwareInterfaceError

_logger = logging.getLogger(__name__)
# Longest period of the loop with which the gains that franka_control configures for
# effort controllers are stable [s].
_SLOWEST_TORQUE_PERIOD = 0.004


def arm_cycles_of(
    period: float, cycle_time: float, arm_id: str, *, is_real: bool = False
) -> int:
    """Return how many cycles of the arm a period of the loop has; warn of a slow loop.

    Args:
        period: Nominal period of the loop [s], > 0.
        cycle_time: Time from one state of the arm to the next [s], > 0.
        arm_id: Name of the arm.
        is_real: Whether the arm needs a command in each of its cycles.

    Raises:
        HardwareInterfaceError: `period` is shorter than the arm's own cycle, or longer
            than that of a real arm.
    """
    if period < 0.999 * cycle_time:
        raise HardwareInterfaceError(
            f"The loop runs at {1.0 / period:g} Hz; arm '{arm_id}' takes at most "
            f"{1.0 / cycle_time:g} commands per second.",
            remedy=f"Set station.rate to {1.0 / cycle_time:g} or less.",
            details={"rate": 1.0 / period},
        )
    if period > _SLOWEST_TORQUE_PERIOD:
        _logger.warning(
            "arm '%s' with a loop of %g Hz: torque controllers need small gains "
            "below %g Hz, above all the damping; franka_control's are too large",
            arm_id,
            1.0 / period,
            1.0 / _SLOWEST_TORQUE_PERIOD,
        )
    cycles = max(1, round(period / cycle_time))
    if is_real and cycles > 1:
        raise HardwareInterfaceError(
            f"The loop runs at {1.0 / period:g} Hz; the real arm '{arm_id}' needs a "
            "command in each of its cycles.",
            remedy=f"Set station.rate to {1.0 / cycle_time:g}.",
            details={"rate": 1.0 / period},
        )
    return cycles
