"""Links that cannot but touch never touch, and it is told."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ParameterError
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.mujoco.mujoco_simulation import rigid_neighbours
from station.hw.urdf_loader import load_urdf
from station.testing import Bench


def robot(name: str, **more: object) -> MujocoRobotHW:
    reference = f"example-robot-data:{name}"
    made = Bench(MujocoRobotHW(), {"robot_description": reference, **more}).robot
    assert isinstance(made, MujocoRobotHW)
    return made


def test_tool_is_a_neighbour_of_the_link_before_the_last_joint() -> None:
    urdf = load_urdf(load_robot_files("example-robot-data:ur5"))
    assert ("ee_link", "wrist_2_link") in rigid_neighbours(urdf)
    # A joint joins them directly.
    assert ("wrist_2_link", "wrist_3_link") not in rigid_neighbours(urdf)


@pytest.mark.parametrize("name", ["a1", "laikago", "ur10"])
def test_robot_that_started_in_contact_stands_still(name) -> None:
    hw = robot(name)
    before = hw.world.data.qpos.copy()
    for cycle in range(300):
        hw.read(0.001 * cycle, 0.001)
        hw.write(0.001 * cycle, 0.001)
    assert abs(hw.world.data.qpos - before).max() < 1e-3


def test_each_reason_is_told() -> None:
    told = [repair.problem for repair in robot("panda").repairs()]
    assert "panda.srdf disables their collisions" in told
    told = [repair.problem for repair in robot("tiago_pro").repairs()]
    assert "they touch in the start pose" in told


@pytest.mark.parametrize(
    ("wanted", "touches"), [("off", False), (False, False), ("all", True)]
)
def test_self_collision_can_be_chosen(wanted, touches) -> None:
    folded = {"elbow_joint": 3.1}
    hw = robot("ur5", self_collision=wanted, initial_positions=folded, floor=False)
    assert bool(hw.world.data.ncon) is touches
    assert not [r for r in hw.repairs() if r.kind == "self_collision"]
    told = [r.sentence() for r in hw.repairs() if r.kind == "start_pose"]
    assert ["touch in the start pose" in one for one in told] == [True] * touches


def test_self_collision_that_is_none_of_the_choices_is_refused() -> None:
    with pytest.raises(ParameterError, match="is 'some'; it must be one of off, srdf"):
        robot("ur5", self_collision="some")


def test_robot_in_the_floor_is_lifted_onto_it_unless_it_has_its_place() -> None:
    (repair,) = [r for r in robot("a1").repairs() if r.kind == "start_pose"]
    assert "stands on the floor" in repair.new
    placed = robot("a1", base_xyz=[0.0, 0.0, 0.0])
    (repair,) = [r for r in placed.repairs() if r.kind == "start_pose"]
    assert "left there" in repair.new
    assert placed.world.data.body("trunk").xpos[2] == 0.0


def test_srdf_is_found_by_the_name_of_the_robot_inside() -> None:
    files = load_robot_files("example-robot-data:baxter")
    assert files.srdf_path is not None
    assert files.srdf_path.name == "baxter_manipulation.srdf"
