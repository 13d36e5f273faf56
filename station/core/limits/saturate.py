"""Clip one number, exactly as the original does."""


def saturate(value: float, low: float, high: float) -> float:
    """Return the number nearest to `value` from `low` to `high`.

    Args:
        value: Any number; NaN is returned as it is.
        low: Lower bound, in the unit of `value`.
        high: Upper bound, in the unit of `value`; it wins where it is below `low`.

    Returns:
        `min(max(value, low), high)`.

    Source:
        ros_control@633c374 joint_limits_interface.h, internal::saturate.
    """
    result = value
    if result < low:
        result = low
    if high < result:
        result = high
    return result
