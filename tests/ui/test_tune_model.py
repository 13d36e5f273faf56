"""How gains are grouped and labelled."""

import pytest

from station.ui.tune_model import (
    GENERAL,
    gain_groups,
    gain_label,
    series_index,
    tunable_controllers,
)
from tests.ui.views import controller, view


def test_running_controllers_come_first_and_controllers_without_claims_are_left_out():
    seen = view(
        controller("a"), controller("b", "running"), controller("state", joints=[])
    )
    assert tunable_controllers(seen) == ["b", "a"]


def test_gains_are_grouped_by_joint():
    groups = gain_groups(["joint1/p", "joint1/d", "joint2/p", "stiffness"])
    assert groups == {
        "joint1": ["joint1/p", "joint1/d"],
        "joint2": ["joint2/p"],
        GENERAL: ["stiffness"],
    }


@pytest.mark.parametrize(
    ("name", "unit", "label"),
    [("joint1/p", "Nm/rad", "p [Nm/rad]"), ("joint1/i_clamp", "", "i clamp")],
)
def test_a_label_has_the_unit(name, unit, label):
    assert gain_label(name, unit) == label


@pytest.mark.parametrize(
    ("group", "index"),
    [("joint2", 1), ("gains/joint2", 1), ("joint2/pid", 1), (GENERAL, 0), ("x", None)],
)
def test_the_series_of_a_group_is_its_joints(group, index):
    assert series_index(["joint1", "joint2"], group) == index
