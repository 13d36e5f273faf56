"""Robots that are loaded to be drawn."""

import math

import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.core.description.urdf_parser import parse_urdf
from station.ui.scene.robot_model import (
    RobotModelError,
    bounds_of,
    link_surfaces,
    load_robot,
)


def test_the_panda_comes_with_its_meshes():
    robot = load_robot("example-robot-data:panda")
    assert (
        sum(len(mesh.faces) for mesh in robot.drawing.scene.geometry.values()) > 100_000
    )


def test_another_arm_id_renames_the_joints():
    robot = load_robot("example-robot-data:panda", "left")
    assert "left_joint1" in robot.urdf.joints
    assert "left_joint1" in robot.drawing.joint_map


def test_joint_limits_leave_fixed_joints_out():
    limits = load_robot("example-robot-data:panda").joint_limits()
    assert limits["panda_joint1"] == pytest.approx((-2.8973, 2.8973))
    assert "panda_joint8" not in limits


def test_an_unknown_robot_is_refused_with_the_known_ones():
    with pytest.raises(RobotModelError, match="panda"):
        load_robot("example-robot-data:nobody")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(RobotModelError, match="nowhere"):
        load_robot(str(tmp_path / "nowhere.urdf"))


def test_a_missing_mesh_is_named(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="l"><visual><geometry>'
        '<mesh filename="package://no_such/thing.stl"/>'
        "</geometry></visual></link></robot>"
    )
    with pytest.raises(RobotModelError, match="no_such"):
        load_robot(str(path))


@pytest.mark.parametrize("robot", ["ur5", "kinova", "talos_left_arm"])
def test_robots_other_than_the_panda_are_drawn(robot):
    loaded = load_robot(f"example-robot-data:{robot}")
    assert loaded.drawing.scene.geometry
    assert list(loaded.urdf.joints) == list(loaded.drawing.joint_map)


def test_the_robot_stands_on_its_base():
    robot = load_robot("example-robot-data:ur5", base=(0.0, 0.1, 0.5, 0.0, 0.0, 0.0))
    drawing = robot.drawing
    placed = drawing.get_transform("base_link", drawing.base_link)
    assert placed[:3, 3] == pytest.approx([0.0, 0.1, 0.5])


def test_a_mesh_in_an_unknown_format_is_refused_with_the_reason(tmp_path):
    (tmp_path / "thing.wavefront").write_bytes(b"not a mesh")
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="l"><visual><geometry>'
        '<mesh filename="thing.wavefront"/></geometry></visual></link></robot>'
    )
    with pytest.raises(RobotModelError, match="cannot be drawn"):
        load_robot(str(path))


def test_the_base_is_where_the_root_link_stands():
    base = (0.1, 0.2, 0.5, 0.0, 0.0, 0.0)
    robot = load_robot("example-robot-data:ur5", base=base)
    assert robot.base_position() == pytest.approx((0.1, 0.2, 0.5))


def test_a_continuous_joint_may_turn_once_in_each_direction(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="a"/><link name="b"/>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'
        "</robot>"
    )
    limits = load_robot(str(path)).joint_limits()
    assert limits == {"j": (-2.0 * math.pi, 2.0 * math.pi)}


def test_a_mistake_in_the_description_has_the_message_of_the_simulation(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text('<robot name="r"><link name="a"/><link name="b"/></robot>')
    with pytest.raises(RobotModelError, match="needs exactly one root link"):
        load_robot(str(path))


ROBOT = """<robot name="r"><link name="base">
<collision><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
<geometry><box size="0.2 0.4 0.6"/></geometry></collision>
<collision><geometry><sphere radius="0.1"/></geometry></collision>
<collision><origin xyz="0 0 2"/>
<geometry><cylinder radius="0.1" length="1"/></geometry></collision>
</link><link name="tip"/>
<joint name="j" type="fixed"><parent link="base"/><child link="tip"/></joint></robot>"""


def _no_mesh(name):
    raise AssertionError(name)


def test_shapes_stand_at_their_origins():
    surfaces = link_surfaces(parse_urdf(ROBOT), _no_mesh)
    assert set(surfaces) == {"base"}
    corners = bounds_of(surfaces, {"base": Pose()})
    # The turned box ends at 1 + 0.4 / 2, the cylinder at 2 + 1 / 2.
    assert corners == pytest.approx(
        np.array([[-0.1, -0.1, -0.3], [1.2, 0.1, 2.5]]), abs=1e-3
    )


def test_bounds_follow_the_poses_of_the_links():
    surfaces = link_surfaces(parse_urdf(ROBOT), _no_mesh)
    half_turn = Pose((0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0))
    corners = bounds_of(surfaces, {"base": half_turn})
    assert corners == pytest.approx(
        np.array([[-1.2, -0.1, 0.7], [0.1, 0.1, 3.5]]), abs=1e-3
    )


def test_faces_of_several_shapes_name_their_own_corners():
    surface = link_surfaces(parse_urdf(ROBOT), _no_mesh)["base"]
    assert surface.faces.max() == len(surface.vertices) - 1
    assert set(np.unique(surface.faces)) == set(range(len(surface.vertices)))


def test_nothing_has_no_bounds():
    assert bounds_of({}, {}) is None
