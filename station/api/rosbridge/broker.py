"""Topics, services, actions and parameters that clients offer to each other.

None of these reaches the station, so every viewer may offer them. A name that begins
like a name of the station belongs to the station: no client gets it, and a client that
had it before loses it.

Source: RobotWebTools/rosbridge_suite, capabilities advertise, advertise_service,
service_response, advertise_action, action_feedback and action_result; differs: a name
that another client already offers is refused; values of types that the station does not
know are passed on unchecked.
"""

import asyncio
import re
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import count
from typing import Any, NamedTuple

from station.api.rosbridge.outbox import Outbox
from station.api.rosbridge.ros_types import RosTypeError, checked, in_style, split_style
from station.api.rosbridge.topics import LATCHED, Topic
from station.core.facade.parameter_server import ParameterServer
from station.core.parameters import Parameters
from station.records.cdr import Values

MOST_OFFERS = 100
"""Most topics, services and actions of a client."""
MOST_PENDING = 64
"""Most requests and goals that wait for one client."""
PATIENCE = 120.0
"""Longest call of a client's service [s]."""
_NAME = re.compile(r"/[A-Za-z]\w*(/\w+)*", re.ASCII)
_TYPE = re.compile(r"\w+(/\w+){1,2}", re.ASCII)
_MOST_CHARACTERS = 200
_ASKED = {
    "services": ("call_service", "service", "Request"),
    "actions": ("send_action_goal", "action", "Goal"),
}
ANSWERED = {
    "service_response": "Response",
    "action_feedback": "Feedback",
    "action_result": "Result",
}
ABORTED = 6
"""ROS 2's status number of an aborted goal."""


@dataclass(slots=True)
class ClientTopic(Topic):
    """A topic of clients, which exists while a client publishes or subscribes.

    Attributes:
        publishers: Clients that publish.
        subscribers: Clients that subscribe.
        latched: Message that a new subscriber gets at once; None without one.
        is_latching: Whether a publisher lets each message become `latched`.
    """

    publishers: set[Outbox] = field(default_factory=set)
    subscribers: set[Outbox] = field(default_factory=set)
    latched: Values | None = None
    is_latching: bool = False


class Offer(NamedTuple):
    """A service or an action of a client.

    Attributes:
        what: services or actions.
        name: Its name.
        type: Its type.
        member: The client.
        written: The name as the client has written it.
        is_ros2: Whether the client has written the type in the style of ROS 2.
    """

    what: str
    name: str
    type: str
    member: Outbox
    written: str
    is_ros2: bool


class Answer(NamedTuple):
    """An answer of a client to a request or a goal.

    Attributes:
        op: The rosbridge operation of the answer.
        values: The result, or the text of an error.
        status: Status number of the goal in ROS 2.
        result: Whether `values` is a result; otherwise it is an error.
    """

    op: str
    values: Any
    status: int = 0
    result: bool = False


class _Pending(NamedTuple):
    offer: Offer
    asker: Outbox
    told: Callable[[Answer], None]


class Broker:
    """Connects clients with each other. Use it in one event loop only.

    Args:
        publish: Publishes a message: topic, type, message.

    Attributes:
        topics: The topics of clients by name.
        offers: The `services` and the `actions` of clients, each by name.
        parameters: The parameters of clients, which the station does not use.
        reserved: First parts of names that belong to the station.
    """

    def __init__(self, publish: Callable[[str, str, Values], None]) -> None:
        self.topics: dict[str, ClientTopic] = {}
        self.offers: dict[str, dict[str, Offer]] = {"services": {}, "actions": {}}
        self.parameters = ParameterServer(
            Parameters(), threading.Lock(), lambda _: False
        )
        self.reserved: frozenset[str] = frozenset()
        self._publish = publish
        self._pending: dict[str, _Pending] = {}
        self._numbers = count(1)

    def reserve(self, names: frozenset[str]) -> None:
        """Reserve first parts of names for the station; end offers with such names."""
        self.reserved = names
        for name in [n for n in self.topics if self.is_reserved(n)]:
            topic = self.topics.pop(name)
            for member in topic.publishers | topic.subscribers:
                member.subscriptions.pop(name, None)
                member.tell("warning", f"'{name}' is a name of the station now.")
        for offer in self._offers():
            if self.is_reserved(offer.name):
                told = f"'{offer.name}' is a name of the station now."
                offer.member.tell("warning", told)
                self._withdraw(offer)

    def is_reserved(self, name: str) -> bool:
        """Return whether a name belongs to the station."""
        return name.strip("/").partition("/")[0] in self.reserved

    def open_topic(self, name: str, type_name: str) -> ClientTopic:
        """Return a new topic to which clients publish.

        Raises:
            RosTypeError: The name or the type is malformed, or the name belongs to the
                station.
        """
        kind, _ = self._checked_name(name, type_name)

        def write(_: object, values: Values) -> None:
            self._publish(name, kind, values)

        topic = ClientTopic(name, kind, write=write, period=LATCHED, changes=False)
        topic.read = lambda _: topic.latched
        self.topics[name] = topic
        return topic

    def advertise(self, topic: ClientTopic, member: Outbox) -> None:
        """Note that a client publishes to a topic.

        Raises:
            RosTypeError: The client offers too many things.
        """
        try:
            if member not in topic.publishers:
                self._check_number(member)
                topic.publishers.add(member)
        finally:
            self.leave_topic(topic.name, member)

    def leave_topic(self, name: str, member: Outbox, *roles: str) -> None:
        """Note that a client leaves a topic, which ends with the last one.

        Args:
            name: The topic; unknown ones are ignored.
            member: The client.
            roles: Roles that it gives up: `publishers`, `subscribers`.
        """
        topic = self.topics.get(name)
        if topic is None:
            return
        for role in roles:
            getattr(topic, role).discard(member)
        if not topic.publishers and not topic.subscribers:
            del self.topics[name]

    def offer(self, what: str, written: str, type_name: str, member: Outbox) -> Offer:
        """Note a client's service or action; return the offer.

        Args:
            what: services or actions.
            written: Its name as the client writes it.
            type_name: Its type.
            member: The client that offers it.

        Raises:
            RosTypeError: The name or the type is malformed, the name belongs to the
                station or to another client, or the client offers too many things.
        """
        name = f"/{written.strip('/')}"
        kind, is_ros2 = self._checked_name(name, type_name)
        known = self.offers[what].get(name)
        if known is not None and known.member is not member:
            raise RosTypeError(f"Another client offers the {what[:-1]} '{name}'.")
        self._check_number(member)
        made = Offer(what, name, kind, member, written, is_ros2)
        self.offers[what][name] = made
        return made

    def take_back(self, what: str, name: str, member: Outbox) -> None:
        """End an offer of a client.

        Raises:
            RosTypeError: The client does not offer this.
        """
        found = self.offers[what].get(f"/{name.strip('/')}")
        if found is None or found.member is not member:
            raise RosTypeError(f"You do not offer the {what[:-1]} '{name:.80}'.")
        self._withdraw(found)

    def leave(self, member: Outbox) -> None:
        """End all offers and requests of a client that leaves."""
        for name in list(self.topics):
            self.leave_topic(name, member, "publishers", "subscribers")
        for offer in self._offers():
            if offer.member is member:
                self._withdraw(offer)
        for number, one in self._pending.items():
            if one.asker is member:
                self._pending[number] = one._replace(told=lambda _: None)

    async def call(self, offer: Offer, args: object, asker: Outbox) -> Values:
        """Return the response of a client's service.

        Raises:
            RosTypeError: The request is malformed, or the client does not answer, or
                its service failed.
        """
        answered: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()

        def told(answer: Answer) -> None:
            if not answered.done():
                answered.set_result(answer)

        number = self.ask(offer, args, asker, told)
        try:
            answer = await asyncio.wait_for(answered, PATIENCE)
        except TimeoutError as error:
            raise RosTypeError(
                f"'{offer.name}' has not answered within {PATIENCE:g} s."
            ) from error
        finally:
            self._pending.pop(number, None)
        if not answer.result:
            raise RosTypeError(f"'{offer.name}' failed: {answer.values!s:.300}")
        found: Values = answer.values
        return found

    def ask(
        self,
        offer: Offer,
        args: object,
        asker: Outbox,
        told: Callable[[Answer], None],
    ) -> str:
        """Pass a request or a goal to the offering client; return its number.

        Args:
            offer: The service or the action.
            args: The request or the goal.
            asker: The client that makes the request.
            told: Function that is called with every answer.

        Raises:
            RosTypeError: The message is malformed, or too many requests wait for the
                client.
        """
        op, key, part = _ASKED[offer.what]
        kind = f"{offer.type}{part}"
        values = in_style(kind, checked(kind, args, "args"), ros2=offer.is_ros2)
        waiting = [p for p in self._pending.values() if p.offer.member is offer.member]
        if len(waiting) >= MOST_PENDING:
            raise RosTypeError(f"{MOST_PENDING} requests wait for '{offer.name}'.")
        number = f"{key}:{offer.name}:{next(self._numbers)}"
        self._pending[number] = _Pending(offer, asker, told)
        message: Values = {"op": op, key: offer.written, "args": values}
        if key == "action":
            message.update({"action_type": offer.type, "feedback": True})
        offer.member.answer(message, number)
        return number

    async def cancel(self, number: str) -> None:
        """Ask the client that carries out a goal to cancel it."""
        pending = self._pending.get(number)
        if pending is not None:
            message = {"op": "cancel_action_goal", "action": pending.offer.written}
            pending.offer.member.answer(message, number)

    def hear(self, message: Mapping[str, Any], member: Outbox) -> None:
        """Pass on the answer of a client to a request or a goal.

        Raises:
            RosTypeError: The message answers no request, or is malformed.
        """
        op, number = message["op"], str(message["id"])
        pending = self._pending.get(number)
        if pending is None or pending.offer.member is not member:
            raise RosTypeError(f"Nobody waits for '{number:.80}' of yours.")
        if op != "action_feedback":
            del self._pending[number]
        values, status = message.get("values"), message.get("status")
        # As in ROS 1, a response with a message counts as a success. `result` is
        # ignored, because roslibpy's servers set it to false.
        is_response = op == "service_response" and isinstance(values, Mapping)
        is_result = is_response or message.get("result") is not False
        code = status if isinstance(status, int) else ABORTED
        answer = Answer(op, values, code, is_result)
        if is_result:
            kind = f"{pending.offer.type}{ANSWERED[op]}"
            try:
                answer = answer._replace(values=checked(kind, values, "values"))
            except RosTypeError as error:
                failed = f"The answer was malformed: {error.message}"
                pending.told(answer._replace(values=failed, result=False))
                raise
        pending.told(answer)

    def _offers(self) -> list[Offer]:
        return [one for known in self.offers.values() for one in known.values()]

    def _withdraw(self, offer: Offer) -> None:
        del self.offers[offer.what][offer.name]
        for number, one in list(self._pending.items()):
            if one.offer is offer:
                del self._pending[number]
                op = "action_result" if offer.what == "actions" else "service_response"
                gone = f"The client that offered '{offer.name}' has withdrawn it."
                one.told(Answer(op, gone, ABORTED))

    def _checked_name(self, name: str, type_name: str) -> tuple[str, bool]:
        """Return the type's name in ROS 1, and whether it was written in ROS 2's style.

        Raises:
            RosTypeError: The name or the type is malformed, or the name belongs to the
                station.
        """
        for pattern, what, given in ((_NAME, "name", name), (_TYPE, "type", type_name)):
            if len(given) > _MOST_CHARACTERS or not pattern.fullmatch(given):
                raise RosTypeError(f"'{given:.80}' is no {what} in ROS.")
        if self.is_reserved(name):
            raise RosTypeError(
                f"'{name}' is a name of the station.",
                remedy="Choose a name with another first part.",
            )
        return split_style(type_name)

    def _check_number(self, member: Outbox) -> None:
        number = sum(one.member is member for one in self._offers())
        number += sum(member in one.publishers for one in self.topics.values())
        if number >= MOST_OFFERS:
            raise RosTypeError(
                f"A client offers {MOST_OFFERS} topics, services and actions at most."
            )
