"""Handles are found by name, torques change slowly."""

import numpy as np
import pytest

from station.controllers.franka_arm import (
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
    saturate_torque_rate,
)
from station.core.errors import (
    ControllerLoadError,
    ParameterError,
    ResourceNotFoundError,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters, ParameterTree
from tests.franka_station import JOINTS, make_franka_station


def test_missing_interface_is_named():
    with pytest.raises(ControllerLoadError, match="no interface 'franka_hw::Fra"):
        find_state(RobotHW(), "panda")


def test_handles_of_an_arm_are_found():
    hw = make_franka_station().loop.hw

    assert claim_torques(hw, JOINTS).names == JOINTS
    assert find_state(hw, "panda").name == "panda_robot"
    assert find_model(hw, "panda").name == "panda_model"
    with pytest.raises(ResourceNotFoundError):
        find_state(hw, "other")


def test_torque_changes_by_at_most_one_newton_metre_per_cycle():
    wanted = np.array([5.0, -5.0, 0.5])

    assert saturate_torque_rate(wanted, [1.0, 1.0, 1.0]) == [2.0, 0.0, 0.5]


def test_an_arm_needs_an_id_and_seven_joints():
    params = Parameters(ParameterTree({"joint_names": ["a"]}))
    with pytest.raises(ParameterError, match="7 different joints"):
        read_arm_joints(params)
    with pytest.raises(ParameterError, match="arm_id"):
        read_arm_id(params)
