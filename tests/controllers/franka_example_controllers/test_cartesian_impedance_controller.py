"""The end effector is held by a spring."""

import pytest

from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


@pytest.fixture
def station():
    return start_example("CartesianImpedance")


def test_arm_stays_where_it_is(station):
    before = Arms(station.robots).state("panda").O_T_EE
    run_without_errors(station, 1.0)

    assert pytest.approx(before, abs=1e-4) == Arms(station.robots).state("panda").O_T_EE


@pytest.mark.slow
def test_force_deflects_the_spring_by_its_stiffness(station):
    run_without_errors(station, 2.0)
    before = Arms(station.robots).state("panda").O_T_EE[13]
    Arms(station.robots).apply_force(
        "panda", "panda_hand", [0, 4.0, 0], [0, 0, 0], 10.0
    )
    run_without_errors(station, 4.0)

    moved = Arms(station.robots).state("panda").O_T_EE[13] - before
    # 4 N at 200 N/m; the hand turns too, and the elbow's spring helps.
    assert moved == pytest.approx(0.02, rel=0.25)


@pytest.mark.slow
def test_arm_follows_the_equilibrium_pose(station):
    pose = Arms(station.robots).state("panda").O_T_EE
    goal = [pose[12] + 0.03, pose[13] - 0.05, pose[14], 0.0, 1.0, 0.0, 0.0]
    station.motion.set_command("example", goal)
    run_without_errors(station, 5.0)

    reached = Arms(station.robots).state("panda").O_T_EE[12:15]
    assert reached == pytest.approx(goal[:3], abs=0.01)


def test_stiffness_is_a_gain(station):
    change = station.tuning.set_gains("example", {"translational_stiffness": 300.0})

    assert change.values["translational_stiffness"] == 300.0
    assert change.values["rotational_stiffness"] == 10.0
