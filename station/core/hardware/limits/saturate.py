"""Clip a number, and compute the velocity that a soft bound allows."""


def saturate(value: float, low: float, high: float) -> float:
    """Return the number nearest to `value` from `low` to `high`.

    Args:
        value: Any number; NaN is returned as it is.
        low: Lower bound, in the unit of `value`.
        high: Upper bound, in the unit of `value`; it wins if it is below `low`.

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


def soft_velocity_bound(
    position: float, bound: float, k_position: float, max_velocity: float
) -> float:
    """Return the velocity that a soft bound allows at a position.

    The velocity falls in proportion to the distance from the bound, is 0 at the bound
    and points back beyond it.

    Args:
        position: Position of the joint [rad or m].
        bound: The soft bound [rad or m].
        k_position: Velocity per distance, >= 0 [1/s].
        max_velocity: Largest magnitude, >= 0 [rad/s or m/s].

    Returns:
        `clip(-k_position * (position - bound), -max_velocity, max_velocity)`.

    Source:
        ros_control@633c374 joint_limits_interface.h, the soft limit handles.
    """
    return saturate(-k_position * (position - bound), -max_velocity, max_velocity)
