"""The parameter `joints`."""

import pytest

from station.controllers.set_point_controller import read_joint_names
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree


def _params(**values):
    return Parameters(ParameterTree({"arm": values}), "arm")


def test_a_group_names_its_joints_in_order():
    assert read_joint_names(_params(joints=["b", "a"])) == ["b", "a"]


@pytest.mark.parametrize("values", [{}, {"joints": []}, {"joints": ["a", "a"]}])
def test_a_group_names_each_joint_once_and_at_least_one(values):
    with pytest.raises(ParameterError, match="arm/joints"):
        read_joint_names(_params(**values))
