"""Which thresholds of contact and collision can be used."""

from dataclasses import replace

import pytest

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.collision_behavior import (
    DEFAULT_COLLISION_BEHAVIOR,
    collision_behavior_problem,
    near_collisions,
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


def test_estimates_near_their_thresholds_are_told_with_both_numbers():
    state = RobotState()
    assert near_collisions(state, DEFAULT_COLLISION_BEHAVIOR) == []
    state.tau_ext_hat_filtered = [15.9, 0.0, 0.0, 0.0, 0.0, 0.0, -10.0]
    state.K_F_ext_hat_K = [-19.1, 15.9, 0.0, 0.0, 0.0, 30.0]

    near = near_collisions(state, DEFAULT_COLLISION_BEHAVIOR)

    assert [(e.name, e.where, e.value, e.limit, e.unit) for e in near] == [
        ("joint_reflex", "joint7", -10.0, 12.0, "Nm"),
        ("cartesian_reflex", "x", -19.1, 20.0, "N"),
        ("cartesian_reflex", "yaw", 30.0, 25.0, "Nm"),
    ]
