"""What an arm that nobody configured allows."""

from math import inf

from station.hw.franka.arm.supervisor_limits import SupervisorLimits


def test_arm_has_no_walls_and_no_limit_of_power_unless_they_are_configured():
    limits = SupervisorLimits()

    assert limits.power == inf
    assert limits.cartesian_lower == (-inf,) * 3
    assert limits.cartesian_upper == (inf,) * 3
