"""Which thresholds of contact and collision can be used."""

from dataclasses import replace

import pytest

from station.hw.franka.arm.collision_behavior import (
    DEFAULT_COLLISION_BEHAVIOR,
    collision_behavior_problem,
)


def test_default_thresholds_can_be_used():
    assert collision_behavior_problem(DEFAULT_COLLISION_BEHAVIOR) is None


@pytest.mark.parametrize(
    ("field", "values", "allowed"),
    [
        ("lower_torque_thresholds_nominal", (1.0,) * 6, "7 numbers"),
        ("lower_force_thresholds_acceleration", (1.0,) * 7, "6 numbers"),
        ("lower_torque_thresholds_acceleration", (0.0,) * 7, "above 0"),
        ("lower_force_thresholds_nominal", (99.0,) * 6, "no lower force threshold"),
    ],
)
def test_threshold_that_cannot_be_used_is_named(field, values, allowed):
    problem = collision_behavior_problem(
        replace(DEFAULT_COLLISION_BEHAVIOR, **{field: values})
    )

    assert problem.field == field
    assert allowed in problem.allowed
