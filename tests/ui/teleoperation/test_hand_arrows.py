"""The arrows at the hand in the 3D view, used as a person does."""

import pytest

from tests.ui.fake_station import HERE

STREAMING = "franka_controllers/CartesianStreamingController"


@pytest.fixture
def panel(bench):
    return bench.dashboard.arrows[0]


@pytest.fixture
def running(bench, panel):
    """A streaming controller runs, and the target is at the end effector."""
    bench.station.pose = list(HERE)
    bench.station.load("stream", STREAMING, running=True)
    assert bench.wait(lambda: panel.gizmo.visible)
    assert bench.wait(lambda: tuple(panel.gizmo.position) == pytest.approx(HERE[:3]))
    bench.station.requests.clear()
    return bench


def drag(bench, panel, position):
    bench.send({
        "type": "TransformControlsUpdateMessage",
        "name": panel.gizmo.name,
        "wxyz": [0.0, 1.0, 0.0, 0.0],
        "position": list(position),
        "owner": "",
    })


def commands(bench):
    return [r[2]["command"] for r in bench.station.requests if r[0] == "PUT"]


def test_the_target_is_hidden_until_a_controller_that_follows_poses_runs(bench, panel):
    bench.station.load("stream", STREAMING)
    assert bench.wait(lambda: bench.link.view().controllers)
    assert bench.wait(lambda: not panel.gizmo.visible)


def test_a_dragged_target_is_sent_until_the_arm_is_there(running, panel):
    drag(running, panel, (0.4, 0.1, 0.5))
    assert running.wait(lambda: commands(running))
    assert commands(running)[0] == pytest.approx([0.4, 0.1, 0.5, 1, 0, 0, 0])
    assert running.wait(lambda: not panel.teleoperation.hands.of("").is_pursuing)
    assert running.station.pose[:3] == pytest.approx([0.4, 0.1, 0.5])


def test_who_drags_the_arrows_is_told_what_is_in_the_way(running, panel):
    running.station.message = "panda_joint4 is near its position limit."
    drag(running, panel, (0.4, 0.1, 0.5))
    told = running.dashboard.reporter
    assert running.wait(lambda: "panda_joint4 is near" in told.message)


def test_a_stop_gives_the_target_up(running, panel):
    drag(running, panel, (0.4, 0.1, 0.5))
    running.station.stop()
    assert running.wait(lambda: not panel.gizmo.visible)
    assert running.wait(lambda: not panel.teleoperation.hands.of("").is_pursuing)
