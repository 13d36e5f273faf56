"""Collision geometry as surfaces."""

import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.core.description.urdf_parser import parse_urdf
from station.ui.scene.robot_model import bounds_of, link_surfaces

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
