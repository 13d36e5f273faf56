"""The services of rosapi: what there is, of which type, and the parameters.

Source: RobotWebTools/rosbridge_suite rosapi; differs: `delete_param` and `set_param`
refuse with the reason, and the parameters are those of the station, besides which
clients have their own.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from station.api.auth import Role
from station.api.rosbridge.actions import Action
from station.api.rosbridge.broker import Offer
from station.api.rosbridge.ros_types import (
    interfaces,
    split_style,
    time_of,
    type_definitions,
)
from station.api.rosbridge.services import RosService
from station.api.rosbridge.topics import Topic
from station.api.tool_port import ToolClient
from station.core.errors import ParameterError, ParameterNotFoundError
from station.records.cdr import Values

if TYPE_CHECKING:
    from station.api.rosbridge.ros_graph import RosGraph

_NODES = ["/station", "/rosapi", "/rosbridge_websocket"]
# Whose messages the station has; clients ask for it to tell ROS 1 from ROS 2.
_DISTRIBUTION = {"rosdistro": "noetic\n"}
MOST_CHARACTERS = 100_000
"""Longest parameters of all clients together, as JSON."""
_Answer = Callable[[Values], Mapping[str, object] | None]


class Rosapi:
    """Makes the services of rosapi.

    Args:
        graph: What there is.
    """

    def __init__(self, graph: "RosGraph") -> None:
        self._there_is = graph
        # What the station has hides what a client has left under the same name.
        self._servers = (graph.station.parameter_server, graph.broker.parameters)

    def all(self) -> Iterator[RosService]:
        """Yield the services of rosapi."""
        answers = {
            name: partial(_without_client, one) for name, one in self._answers().items()
        }
        for name, call in answers.items():
            kind = "".join(word.capitalize() for word in name.split("_"))
            kind = {"ActionServers": "GetActionServers"}.get(kind, kind)
            yield RosService(f"/rosapi/{name}", f"rosapi/{kind}", call)
        for name, change in (("set_param", self._set), ("delete_param", self._delete)):
            kind = f"rosapi/{name.partition('_')[0].capitalize()}Param"
            yield RosService(
                f"/rosapi/{name}", kind, change, changes=True, is_free=self._is_clients
            )

    def _is_clients(self, client: ToolClient, request: Values) -> bool:
        """Return whether a parameter is one of clients: nobody else sees it.

        Those of the station are for operators. A viewer's are of the kind in which
        pages and scripts leave each other values.
        """
        if not client.access.role.includes(Role.OPERATOR):
            return not self._there_is.broker.is_reserved(request["name"])
        return False

    def _answers(self) -> dict[str, _Answer]:
        there = self._there_is
        return {
            "topics": lambda _: _names_and_types(there.topics),
            "topics_and_raw_types": lambda _: {
                **_names_and_types(there.topics),
                "typedefs_full_text": [""] * len(there.topics),
            },
            "topics_for_type": lambda q: {"topics": _of_type(there.topics, q["type"])},
            "topic_type": lambda q: {"type": _type_of(there.topics, q["topic"])},
            "publishers": lambda q: {
                "publishers": _NODES[:1] if q["topic"] in self._published() else []
            },
            "subscribers": lambda q: {
                "subscribers": _NODES[:1] if q["topic"] in self._subscribed() else []
            },
            "services": lambda _: {"services": list(there.services)},
            "services_for_type": lambda q: {
                "services": _of_type(there.services, q["type"])
            },
            "service_type": lambda q: {"type": _type_of(there.services, q["service"])},
            "service_node": lambda q: {"node": self._node_of(q["service"])},
            "service_providers": lambda q: {
                "providers": [self._node_of(q["service"])]
                * (q["service"] in there.services)
            },
            "message_details": partial(_details, ""),
            "service_request_details": partial(_details, "Request"),
            "service_response_details": partial(_details, "Response"),
            "action_goal_details": partial(_details, "Goal"),
            "action_result_details": partial(_details, "Result"),
            "action_feedback_details": partial(_details, "Feedback"),
            "action_servers": lambda _: {"action_servers": list(there.actions)},
            "action_type": lambda q: {"type": _type_of(there.actions, q["action"])},
            "interfaces": lambda _: {"interfaces": interfaces()},
            "nodes": lambda _: {"nodes": _NODES},
            "node_details": self._node_details,
            "get_param_names": lambda _: {"names": [f"/{n}" for n in self._names()]},
            "get_param": self._get,
            "has_param": lambda q: {"exists": self._find(q["name"]) is not None},
            "search_param": lambda q: {
                "global_name": f"/{q['name'].strip('/')}"
                if self._find(q["name"]) is not None
                else ""
            },
            "get_time": lambda _: {"time": time_of(there.clock.now())},
        }

    def _published(self) -> list[str]:
        topics = self._there_is.topics.values()
        return [topic.name for topic in topics if topic.write is None]

    def _subscribed(self) -> list[str]:
        topics = self._there_is.topics.values()
        return [topic.name for topic in topics if topic.write is not None]

    def _node_of(self, service: str) -> str:
        if service not in self._there_is.services:
            return ""
        return _NODES[1] if service.startswith("/rosapi/") else _NODES[0]

    def _node_details(self, request: Values) -> Values:
        node = request["node"]
        is_station = node == _NODES[0]
        return {
            "subscribing": self._subscribed() if is_station else [],
            "publishing": self._published() if is_station else [],
            "services": [
                s for s in self._there_is.services if self._node_of(s) == node
            ],
        }

    def _names(self) -> Iterator[str]:
        """Yield the names of all parameters that are no namespaces."""
        trees = [("", one.get()) for one in self._servers]
        pending = [*trees, *_DISTRIBUTION.items()]
        while pending:
            path, value = pending.pop(0)
            if not isinstance(value, dict) or (path and not value):
                yield path
                continue
            inside = ((f"{path}/{key}".strip("/"), one) for key, one in value.items())
            pending.extend(inside)

    def _find(self, name: str) -> object | None:
        path = name.strip("/")
        for server in self._servers:
            with suppress(ParameterNotFoundError):
                return server.get(path)
        return _DISTRIBUTION.get(path)

    def _get(self, request: Values) -> Values:
        """Return a parameter as JSON, or the default that the client names."""
        found = self._find(request["name"])
        if found is None:
            return {"value": request["default"] or "null"}
        return {"value": json.dumps(found, default=str)}

    def _set(self, client: ToolClient, request: Values) -> None:
        """Set a parameter.

        Raises:
            ParameterError: The value is no JSON, or the parameter cannot be set.
        """
        server, path = self._servers[0], request["name"].strip("/")
        if self._is_clients(client, request):
            server = self._servers[1]
            held = len(json.dumps(server.get())) + len(path) + len(request["value"])
            if held > MOST_CHARACTERS:
                raise ParameterError(
                    f"'{path:.80}' is too much: the parameters of clients have "
                    f"{MOST_CHARACTERS} characters together at most.",
                    remedy="Delete some.",
                )
        try:
            value = json.loads(request["value"])
        except (ValueError, RecursionError) as error:
            raise ParameterError(
                f"The value of '{request['name']}' is no JSON: {error}.",
                remedy='Send a text as "\\"text\\"", a number as "1.5".',
            ) from error
        server.set(path, value)

    def _delete(self, client: ToolClient, request: Values) -> None:
        server = self._servers[self._is_clients(client, request)]
        server.delete(request["name"].strip("/"))


def _without_client(
    answer: _Answer, _: ToolClient, request: Values
) -> Mapping[str, object] | None:
    return answer(request)


def _names_and_types(topics: Mapping[str, Topic]) -> Values:
    return {"topics": list(topics), "types": [one.type for one in topics.values()]}


def _of_type(
    found: Mapping[str, Topic | RosService | Offer], type_name: str
) -> list[str]:
    wanted = split_style(type_name)[0]
    return [name for name, one in found.items() if one.type == wanted]


def _type_of(
    found: Mapping[str, Topic | RosService | Action | Offer], name: str
) -> str:
    return found[name].type if name in found else ""


def _details(suffix: str, request: Values) -> Values:
    name = split_style(request["type"])[0]
    return {"typedefs": type_definitions(name + suffix)}
