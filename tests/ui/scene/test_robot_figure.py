"""A second, translucent figure of a robot."""

import pytest

from station.ui.scene.robot_model import load_robot
from station.ui.scene.robot_scene import RobotFigure


@pytest.fixture
def figure(shared_bench):
    robot = load_robot("example-robot-data:panda")
    figure = RobotFigure(shared_bench.guarded.server, robot, "/figure", (1, 2, 3))
    yield figure
    figure.remove()


def test_a_figure_is_hidden_until_it_is_shown(figure, shared_bench):
    scene = shared_bench.guarded.server.scene
    assert not figure.is_shown
    figure.show({"panda_joint1": 0.5})
    assert figure.is_shown
    assert scene.get_handle_by_name("/figure").visible
    figure.hide()
    assert not scene.get_handle_by_name("/figure").visible


def test_a_figure_stands_at_its_joint_positions(figure):
    figure.show({"panda_joint1": 1.0})
    turned = tuple(
        next(
            f.handle for f in figure.frames.frames if f.joint.name == "panda_joint1"
        ).wxyz
    )
    # A turn about z by 1 rad: (cos 0.5, 0, 0, sin 0.5).
    assert turned == pytest.approx((0.8776, 0.0, 0.0, 0.4794), abs=1e-4)


def test_a_figure_consists_of_the_collision_geometry(figure, shared_bench):
    assert figure is not None
    scene = shared_bench.guarded.server.scene
    surface = scene.get_handle_by_name("/figure/panda_link0/panda_link1/surface")
    assert len(surface.faces) == 300
