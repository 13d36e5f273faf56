"""The closed list of what goes from a page to the station."""

import pytest

from station.ui.gateway.forwarded_routes import may_ask, may_forward, may_stream
from station.ui.sessions.sessions import Role


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/status"),
        ("PATCH", "/controllers/arm/gains"),
        ("DELETE", "/controllers/arm/goals/3"),
        ("POST", "/robots/panda/gripper/grasp"),
        ("GET", "/incidents/2026-11-22T13.05"),
        ("GET", "/incidents/2026-11-22T13.05/table"),
        ("POST", "/waypoint-paths/wave/capture"),
        ("DELETE", "/playback"),
        ("POST", "/experiments/better/apply"),
    ],
)
def test_what_a_panel_needs_is_forwarded(method, path):
    assert may_forward(method, path)


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("POST", "/login"),
        ("POST", "/stream-tickets"),
        ("POST", "/tokens"),
        ("GET", "/session"),
        ("GET", "/control"),
        ("POST", "/control"),
        ("PUT", "/parameters/x"),
        ("POST", "/controller-types/reload"),
        ("DELETE", "/status"),
        ("DELETE", "/experiments/better"),
        ("DELETE", "/recordings/x"),
        ("GET", "/controllers/../status"),
        ("GET", "/controllers/a/b/c"),
        ("GET", "/status/"),
        ("GET", "/status\n"),
    ],
)
def test_all_else_is_not(method, path):
    assert not may_forward(method, path)


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("GET", "/status", True),
        ("POST", "/stop", True),
        ("POST", "/stop/release", False),
        ("PUT", "/controllers/arm/command", False),
    ],
)
def test_viewers_read_and_stop(method, path, allowed):
    assert may_ask(Role.VIEWER, method, path) is allowed
    assert may_ask(Role.OPERATOR, method, path)


@pytest.mark.parametrize(
    ("topic", "allowed"),
    [
        ("joint_states", True),
        ("robot_state/panda", True),
        ("controller_state/arm", True),
        ("controller_state/../loop", False),
        ("command/arm", False),
        ("", False),
    ],
)
def test_streams_that_panels_read(topic, allowed):
    assert may_stream(topic) is allowed
