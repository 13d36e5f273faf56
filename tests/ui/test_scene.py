"""The robot in 3D."""

import pytest

from station.ui.robot_model import load_robot
from station.ui.scene import RobotScene


@pytest.fixture(scope="module")
def scene(shared_bench):
    return RobotScene(
        shared_bench.guarded.server, load_robot("example-robot-data:panda")
    )


def _handle(scene, name):
    return next(m.handle for m in scene._moving if m.joint.name == name)


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
    scene.show({"elbow_of_somebody_else": 1.0})


def test_a_pose_shown_already_is_not_sent_again(scene, monkeypatch):
    scene.show({"panda_joint2": 0.5})
    sent = []
    server = scene._server
    monkeypatch.setattr(server._websock_server, "queue_message", sent.append)
    scene.show({"panda_joint2": 0.5})
    assert sent == []


@pytest.mark.parametrize("height", [0.0, 1.5])
def test_the_camera_looks_at_the_robot(shared_bench, height):
    server = shared_bench.guarded.server
    base = (0.0, 0.0, height, 0.0, 0.0, 0.0)
    RobotScene(server, load_robot("example-robot-data:panda", base=base))
    assert server.initial_camera.look_at[2] == pytest.approx(height + 0.42, abs=0.02)


def test_the_base_is_the_first_link(scene):
    assert scene.base == "/robot/panda_link0"
