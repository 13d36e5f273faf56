"""The graph of a station: topics, services and actions by name, and rosapi's services.

Source: RobotWebTools/rosbridge_suite rosapi; differs: `delete_param` and `set_param`
refuse with the reason; the parameters are those of the station, and clients have
further ones of their own.
"""

import json
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

from station.api.auth import Role
from station.api.rosbridge.actions import Action, StationActions
from station.api.rosbridge.broker import Broker, ClientTopic, Offer
from station.api.rosbridge.ros_types import (
    INTERFACES,
    RosTypeError,
    split_style,
    time_of,
    type_definitions,
    type_named,
)
from station.api.rosbridge.services import RosService, StationServices
from station.api.rosbridge.tf_republisher import TfRepublisher
from station.api.rosbridge.topics import StationTopics, Topic
from station.api.services import Services
from station.api.tool_port import ToolClient
from station.core.description.urdf import Urdf
from station.core.errors import ParameterError, ParameterNotFoundError, suggest
from station.records.cdr import Values

_NODES = ["/station", "/rosapi", "/rosbridge_websocket"]
# Distribution whose messages the station has; clients use it to distinguish ROS 1 and
# ROS 2.
_DISTRIBUTION = {"rosdistro": "noetic\n"}
MOST_CHARACTERS = 100_000
"""Largest size of the parameters of all clients together, as JSON [characters]."""
_Known = Mapping[str, Any]
_Answer = Callable[[Values], Mapping[str, object] | None]


class RosGraph:
    """The present topics, services and actions. Use it in one event loop only.

    Args:
        services: The services of the API.
        urdf: The robot, for transforms; None sends no transforms.
        texts: Text by topic, such as `/robot_description`.
        publish: Publishes a message: topic, type, message.

    Attributes:
        station: The station.
        broker: Topics, services and actions that clients offer to each other.
        topics: All topics by name; the station's topics hide those of clients.
        services: All services by name, in the same way.
        actions: All actions by name, in the same way.
        clock: The station's topics, which make the messages of cycles and know their
            time.
        goals: Follows the goals of clients.
    """

    def __init__(
        self,
        services: Services,
        urdf: Urdf | None,
        texts: Mapping[str, str],
        publish: Callable[[str, str, Values], None],
    ) -> None:
        self.station = station = services.station
        self.broker = Broker(publish)
        topics: Any = self.broker.topics
        offers: dict[str, Any] = self.broker.offers
        self.topics = ChainMap[str, Topic]({}, topics)
        self.services = ChainMap[str, RosService | Offer]({}, offers["services"])
        self.actions = ChainMap[str, Action | Offer]({}, offers["actions"])
        self.clock = StationTopics(services, urdf, texts)
        self.goals = StationActions(station, self.clock, publish)
        self._services = StationServices(station, self.clock)
        self._rosapi = Rosapi(self)
        self._republishers: list[TfRepublisher] = []
        if urdf is not None:
            self._republishers = [TfRepublisher(urdf, self.clock, self._add)]
        self._known: list[tuple[str, str]] = []

    def _add(self, topic: Topic) -> None:
        self.topics.maps[0][topic.name] = topic

    def _loaded(self) -> list[tuple[str, str]]:
        conditions = self.station.manager.conditions()
        return [(one.name, one.type) for one in conditions]

    def refresh(self) -> None:
        """Update topics, services and actions to the loaded controllers."""
        self._known = self._loaded()
        actions, own = list(self.goals.all()), self.topics.maps[0]
        topics = list(self.clock.all())
        services = [*self._services.all(), *self._rosapi.all()]
        for one in self._republishers:
            actions.append(one.action)
            services.append(one.service)
            topics += one.topics()
        self.actions.maps[0] = {one.name: one for one in actions}
        for action in actions:
            topics += self.goals.topics_of(action)
        # Keep the object of a topic that stays, with the time and content of its last
        # message.
        self.topics.maps[0] = {
            one.name: old
            if (old := own.get(one.name)) is not None and old.type == one.type
            else one
            for one in topics
        }
        self.services.maps[0] = {one.name: one for one in services}
        names = [*self.topics.maps[0], *self.services.maps[0], *self.actions.maps[0]]
        names += [name for name, _ in self._known]
        root = self.station.parameter_server.get()
        names += root if isinstance(root, dict) else ()
        self.broker.reserve(frozenset(n.strip("/").partition("/")[0] for n in names))

    def find(self, what: str, name: str, type_name: str = "") -> Any:  # noqa: ANN401 - of the kind of `what`
        """Return a topic, a service or an action.

        Args:
            what: topics, services or actions.
            name: Its name.
            type_name: Its type in either style; empty accepts any type.

        Raises:
            RosTypeError: The name is unknown, or it has another type.
        """
        name, known = path_of(name), getattr(self, what)
        # A refresh costs a millisecond, and clients may ask often, so refresh only
        # after a change.
        if name not in known.maps[0] and self._known != self._loaded():
            self.refresh()
        if name not in known:
            raise RosTypeError(
                f"There is no {what[:-1]} '{name:.80}'.", remedy=suggest(name, known)
            )
        found = known[name]
        if type_name and split_style(type_name)[0] != found.type:
            raise RosTypeError(
                f"'{name}' has the type {found.type}, not {type_name:.80}."
            )
        return found


def path_of(name: object) -> str:
    """Return a name with a leading slash, which roslibjs omits: `rosapi/topics`."""
    return f"/{str(name).strip('/')}"


class Rosapi:
    """Provides the services of rosapi.

    Args:
        graph: Topics, services and nodes.
    """

    def __init__(self, graph: RosGraph) -> None:
        self._there_is = graph
        # A parameter of the station hides a client's parameter of the same name.
        self._servers = (graph.station.parameter_server, graph.broker.parameters)

    def all(self) -> Iterator[RosService]:
        """Yield the services of rosapi."""
        for name, answer in self._answers().items():
            kind = type_named("rosapi", name)
            kind = {"rosapi/ActionServers": "rosapi/GetActionServers"}.get(kind, kind)
            call = partial(_without_client, answer)
            yield RosService(f"/rosapi/{name}", kind, call)
        for name, change in (("set_param", self._set), ("delete_param", self._delete)):
            yield RosService(
                f"/rosapi/{name}",
                type_named("rosapi", name),
                change,
                changes=True,
                is_free=self._is_clients,
            )

    def _is_clients(self, client: ToolClient, request: Values) -> bool:
        """Return whether a parameter belongs to clients only.

        Only operators may change the station's parameters. Viewers may change those of
        clients, by which pages and scripts exchange values.
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
            "topics_for_type": lambda q: {"topics": _of_type(there.topics, q)},
            "topic_type": lambda q: {"type": _type_of(there.topics, q["topic"])},
            "publishers": lambda q: {"publishers": self._users(q["topic"], 0)},
            "subscribers": lambda q: {"subscribers": self._users(q["topic"], 1)},
            "services": lambda _: {"services": list(there.services)},
            "services_for_type": lambda q: {"services": _of_type(there.services, q)},
            "service_type": lambda q: {"type": _type_of(there.services, q["service"])},
            "service_node": lambda q: {"node": "".join(self._providers(q["service"]))},
            "service_providers": lambda q: {"providers": self._providers(q["service"])},
            "action_servers": lambda _: {"action_servers": list(there.actions)},
            "action_type": lambda q: {"type": _type_of(there.actions, q["action"])},
            "interfaces": lambda _: {"interfaces": INTERFACES},
            "message_details": partial(_details, ""),
            "service_request_details": partial(_details, "Request"),
            "service_response_details": partial(_details, "Response"),
            "action_goal_details": partial(_details, "Goal"),
            "action_result_details": partial(_details, "Result"),
            "action_feedback_details": partial(_details, "Feedback"),
            "nodes": lambda _: {"nodes": _NODES},
            "node_details": self._node_details,
            "get_param_names": lambda _: {"names": [f"/{n}" for n in self._names()]},
            "get_param": self._get,
            "has_param": lambda q: {"exists": self._find(q["name"]) is not None},
            "search_param": lambda q: {
                "global_name": f"/{q['name'].strip('/')}"
                * (self._find(q["name"]) is not None)
            },
            "get_time": lambda _: {"time": time_of(there.clock.now())},
        }

    def _users(self, name: str, role: int) -> list[str]:
        """Return the nodes that publish (role 0) or subscribe to (role 1) a topic."""
        topic = self._there_is.topics.get(name)
        if isinstance(topic, ClientTopic):
            members = (topic.publishers, topic.subscribers)[role]
            return _NODES[2:] if members else []
        fits = topic is not None and (topic.write is None) is (role == 0)
        return _NODES[:1] if fits else []

    def _providers(self, name: str) -> list[str]:
        service = self._there_is.services.get(name)
        if service is None:
            return []
        if isinstance(service, Offer):
            return _NODES[2:]
        return _NODES[1:2] if name.startswith("/rosapi/") else _NODES[:1]

    def _node_details(self, request: Values) -> Values:
        node, there = request["node"], self._there_is
        return {
            "publishing": [n for n in there.topics if node in self._users(n, 0)],
            "subscribing": [n for n in there.topics if node in self._users(n, 1)],
            "services": [n for n in there.services if node in self._providers(n)],
        }

    def _names(self) -> Iterator[str]:
        """Yield the names of all parameters, without namespaces."""
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
        """Return a parameter as JSON, or the client's default."""
        found = self._find(request["name"])
        if found is None:
            return {"value": request["default"] or "null"}
        return {"value": json.dumps(found, default=str)}

    def _set(self, client: ToolClient, request: Values) -> None:
        """Set a parameter.

        Raises:
            ParameterError: The value is not JSON, or the parameter cannot be set.
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


def _of_type(known: _Known, request: Values) -> list[str]:
    wanted = split_style(request["type"])[0]
    return [name for name, one in known.items() if one.type == wanted]


def _type_of(known: _Known, name: str) -> str:
    return known[name].type if name in known else ""


def _details(suffix: str, request: Values) -> Values:
    name = split_style(request["type"])[0]
    return {"typedefs": type_definitions(name + suffix)}
