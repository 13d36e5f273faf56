"""The robot in 3D."""

import pytest

from station.ui.scene.robot_model import RobotModelError, load_robot
from station.ui.scene.robot_scene import RobotFigure, RobotScene


@pytest.fixture(scope="module")
def scene(shared_bench):
    return RobotScene(
        shared_bench.guarded.server, load_robot("example-robot-data:panda")
    )


def _handle(scene, name):
    return next(f.handle for f in scene.moving.frames if f.joint.name == name)


def test_a_joint_turns_its_frame(scene):
    handle = _handle(scene, "panda_joint1")
    scene.show({"panda_joint1": 0.0})
    before = tuple(handle.wxyz)
    scene.show({"panda_joint1": 1.0})
    assert tuple(handle.wxyz) != before


def test_fingers_slide_and_follow_each_other(scene):
    scene.show({"panda_finger_joint1": 0.02})
    near, far = (_handle(scene, f"panda_finger_joint{i}") for i in (1, 2))
    assert abs(near.position[1]) == pytest.approx(0.02)
    assert abs(far.position[1]) == pytest.approx(0.02)


def test_names_the_robot_does_not_have_are_skipped(scene):
    handle = _handle(scene, "panda_joint1")
    before = tuple(handle.wxyz)

    scene.show({"elbow_of_somebody_else": 1.0, "panda_joint1": 0.7})

    assert tuple(handle.wxyz) != before


def test_a_pose_shown_already_is_not_sent_again(scene, monkeypatch):
    scene.show({"panda_joint2": 0.5})
    sent = []
    server = scene._server
    monkeypatch.setattr(server._websock_server, "queue_message", sent.append)
    scene.show({"panda_joint2": 0.5})
    assert sent == []


@pytest.mark.parametrize("height", [0.0, 1.5])
def test_the_camera_looks_at_the_first_pose_of_the_robot(shared_bench, height):
    server = shared_bench.guarded.server
    base = (0.0, 0.0, height, 0.0, 0.0, 0.0)
    robot = RobotScene(server, load_robot("example-robot-data:panda", base=base))
    straight = server.initial_camera.look_at[2]
    robot.show({"panda_joint4": -2.0, "panda_joint6": 2.0})
    bent = server.initial_camera.look_at
    # Middle of 0 to 0.75 m; the arm is 1.1 m when it is straight.
    assert bent[2] == pytest.approx(height + 0.375, abs=0.02)
    assert straight == pytest.approx(height + 0.557, abs=0.02)
    robot.show({"panda_joint4": -1.0})
    assert server.initial_camera.look_at == pytest.approx(bent)


@pytest.mark.parametrize(
    ("robot", "height", "stands"),
    [("panda", 0.5, True), ("panda", 0.0, False), ("talos_left_arm", 1.2, False)],
)
def test_a_raised_robot_stands_on_something_unless_it_hangs(
    shared_bench, monkeypatch, robot, height, stands
):
    server = shared_bench.guarded.server
    drawn = []
    monkeypatch.setattr(
        server.scene, "add_cylinder", lambda name, **_: drawn.append(name)
    )
    base = (0.0, 0.0, height, 0.0, 0.0, 0.0)
    scene = RobotScene(server, load_robot(f"example-robot-data:{robot}", base=base))
    scene.show({"panda_joint4": -2.0, "arm_left_4_joint": -1.2})
    assert bool(drawn) is stands


def test_meshes_that_are_no_surfaces_are_refused(shared_bench, monkeypatch):
    server = shared_bench.guarded.server
    robot = load_robot("example-robot-data:panda")

    def fail(*_, **__):
        raise AssertionError("no triangles")

    monkeypatch.setattr(server.scene, "add_mesh_trimesh", fail)
    with pytest.raises(RobotModelError, match="no triangles"):
        RobotScene(server, robot)


def test_the_base_is_the_first_link(scene):
    assert scene.base == "/robot/panda_link0"


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
