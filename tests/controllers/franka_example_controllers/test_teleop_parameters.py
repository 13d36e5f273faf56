"""Parameters of the teleoperation are those of its YAML file."""

import numpy as np
import pytest

from station.controllers.franka_example_controllers.teleop_joint_pd_controller import (
    LeaderDamping,
    bounds_of,
    read_teleop_gains,
    read_teleop_parameters,
    teleop_schema,
)
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from tests.conformance.benches import CONTROLLER_PARAMETERS

ROLES = {role: CONTROLLER_PARAMETERS[role] for role in ("leader", "follower")}


def params(**changes):
    view = Parameters(ParameterTree(ROLES))
    for key, value in changes.items():
        view.set(key.replace("__", "/"), value)
    return view


def test_seven_numbers_are_needed():
    with pytest.raises(ParameterError, match="follower/p_gains"):
        read_teleop_parameters(params(follower__p_gains=[1.0]))
    with pytest.raises(ParameterError, match="leader/contact_force_threshold"):
        read_teleop_gains(params(leader__contact_force_threshold="much"))


def test_bounds_are_run_time_parameters():
    gains = read_teleop_gains(params())
    gains["dq_u_2"] = 1.5

    bounds = bounds_of(gains)
    assert bounds.velocity_near.tolist() == [2.0, 1.5, 2.0, 2.0, 2.5, 2.5, 2.5]
    assert bounds.acceleration_far.tolist() == [0.8] * 4 + [10.0] * 3
    assert teleop_schema(gains)["ddq_u_2"].maximum == 7.5


def test_configured_value_widens_its_range():
    far = [3.0] * 7
    gains = read_teleop_gains(params(follower__dq_max_upper=far))

    assert teleop_schema(gains)["dq_u_1"].maximum == 3.0


def test_fast_leader_is_damped_more():
    damping = LeaderDamping(*(np.full(7, x) for x in (1.0, 35.0, 1.3, 1.9)))

    dq = np.array([0.0, 1.3, -1.6, 1.9, 5.0, -5.0, 1.6])
    expected = [1.0, 1.0, 18.0, 35.0, 35.0, 35.0, 18.0]
    assert damping.damping(dq) == pytest.approx(expected)
