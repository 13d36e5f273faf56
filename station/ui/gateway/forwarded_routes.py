"""The requests of the dashboard's pages that the gateway forwards to the station.

The list is closed: a route that no panel needs cannot be reached through the
dashboard's cookie. The station still decides by role and state.
"""

import re
from dataclasses import dataclass

from station.ui.sessions.sessions import Role

_READ = ("GET",)
_ROUTES: tuple[tuple[tuple[str, ...], str], ...] = (
    (_READ, "/status"),
    (_READ, "/hardware"),
    (_READ, "/joint_states"),
    (_READ, "/loop"),
    (("POST",), "/loop/statistics/reset"),
    (("GET", "POST"), "/controllers"),
    (("POST",), "/controllers/switch"),
    (("GET", "DELETE"), "/controllers/{}"),
    (("GET", "PATCH"), "/controllers/{}/gains"),
    (("GET", "PUT"), "/controllers/{}/command"),
    (("POST",), "/controllers/{}/bench"),
    (_READ, "/lessons"),
    (("POST",), "/lessons/{}/begin"),
    (("POST",), "/lessons/{}/check"),
    (_READ, "/bench-runs"),
    (("GET", "DELETE"), "/bench-runs/{}"),
    (_READ, "/controllers/{}/state"),
    (_READ, "/controllers/{}/query_state"),
    (("GET", "POST"), "/controllers/{}/goals"),
    (("GET", "DELETE"), "/controllers/{}/goals/{}"),
    (("POST",), "/controllers/{}/trajectory"),
    (_READ, "/controller-types"),
    (_READ, "/gain-sets"),
    (("POST",), "/gain-sets/undo"),
    (("GET", "PUT", "DELETE"), "/gain-sets/{}"),
    (("POST",), "/gain-sets/{}/apply"),
    (_READ, "/plot-layouts"),
    (("GET", "PUT", "DELETE"), "/plot-layouts/{}"),
    (_READ, "/waypoint-paths"),
    (("GET", "PUT", "DELETE"), "/waypoint-paths/{}"),
    (("POST",), "/waypoint-paths/{}/capture"),
    (("POST",), "/waypoint-paths/{}/play"),
    (("GET", "PATCH", "DELETE"), "/playback"),
    (("GET", "POST"), "/stop"),
    (("POST",), "/stop/release"),
    (_READ, "/scene"),
    (_READ, "/cameras"),
    (_READ, "/cameras/{}"),
    (("PUT", "DELETE"), "/scene/{}"),
    (("POST",), "/rehearse"),
    (("POST",), "/plan"),
    (("GET", "PATCH"), "/simulation"),
    (("POST",), "/simulation/step"),
    (("POST",), "/simulation/reset"),
    (_READ, "/robots"),
    (("POST",), "/robots/error_recovery"),
    (_READ, "/robots/{}/state"),
    (_READ, "/robots/{}/model"),
    (_READ, "/robots/{}/errors"),
    (("PUT",), "/robots/{}/ee_frame"),
    (("PUT",), "/robots/{}/load"),
    (("PUT",), "/robots/{}/force_torque_collision_behavior"),
    (("POST",), "/robots/{}/error_recovery"),
    (("POST",), "/robots/{}/guiding"),
    (("POST",), "/robots/{}/user_stop"),
    (("POST",), "/robots/{}/external_force"),
    (("GET", "POST", "DELETE"), "/robots/{}/faults"),
    (_READ, "/robots/{}/gripper"),
    (("POST",), "/robots/{}/gripper/{}"),
    (("GET", "POST"), "/experiments"),
    (_READ, "/experiments/{}"),
    (("POST",), "/experiments/{}/cancel"),
    (_READ, "/experiments/{}/responses"),
    (_READ, "/experiments/{}/preview"),
    (("POST",), "/experiments/{}/apply"),
    (_READ, "/events"),
    (_READ, "/agents/requests"),
    (("POST",), "/agents/requests/{}"),
    (_READ, "/alarms"),
    (("POST",), "/alarms/{}/acknowledge"),
    (("GET", "POST"), "/recordings"),
    (("POST",), "/recordings/upload"),
    (_READ, "/recordings/{}"),
    (("POST",), "/recordings/{}/stop"),
    (_READ, "/recordings/{}/file"),
    (_READ, "/recordings/{}/table"),
    (_READ, "/recordings/{}/events"),
    (("POST",), "/recordings/{}/notes"),
    (("POST",), "/recordings/{}/bench"),
    (_READ, "/incidents"),
    (_READ, "/incidents/{}"),
    (_READ, "/incidents/{}/file"),
    (_READ, "/incidents/{}/table"),
    (_READ, "/incidents/{}/events"),
    (("POST",), "/incidents/{}/notes"),
    (("POST",), "/incidents/{}/bench"),
)
_STREAMS = (
    "joint_states",
    "robot_state",
    "robot_state/{}",
    "controllers",
    "controller_state/{}",
    "loop",
    "scene",
    "events",
)
_FOR_VIEWERS = frozenset({("POST", "/stop")})
_SEGMENT = r"(?!\.{1,2}(?:/|$))[A-Za-z0-9_.-]{1,128}"


@dataclass(frozen=True, slots=True)
class _Pattern:
    methods: frozenset[str]
    expression: re.Pattern[str]


def _compiled(template: str) -> re.Pattern[str]:
    return re.compile(re.escape(template).replace(r"\{\}", _SEGMENT))


_PATTERNS = tuple(
    _Pattern(frozenset(methods), _compiled(template)) for methods, template in _ROUTES
)
_TOPICS = tuple(_compiled(template) for template in _STREAMS)


def may_forward(method: str, path: str) -> bool:
    """Return whether a request may go to the station.

    Args:
        method: The HTTP method in capitals.
        path: The path below `PREFIX`, with its percent escapes resolved.
    """
    return any(
        method in pattern.methods and pattern.expression.fullmatch(path)
        for pattern in _PATTERNS
    )


def may_ask(role: Role, method: str, path: str) -> bool:
    """Return whether a browser with this role may send a request that is forwarded.

    The station checks the role as well: a request carries the token of its session.
    """
    return role is Role.OPERATOR or method == "GET" or (method, path) in _FOR_VIEWERS


def may_stream(topic: str) -> bool:
    """Return whether a stream of the station may go to a browser."""
    return any(pattern.fullmatch(topic) for pattern in _TOPICS)
