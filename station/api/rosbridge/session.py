"""One client of rosbridge: its subscriptions, publications, calls and goals.

Source: RobotWebTools/rosbridge_suite ROSBRIDGE_PROTOCOL.md and rosbridge_library's
capabilities.
"""

import asyncio
import hashlib
import hmac
import inspect
import json
import logging
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from functools import partial
from typing import TYPE_CHECKING, Any

import orjson

from station.api.auth import Access, Role
from station.api.json_route import DoubleNameError, check_names
from station.api.rosbridge.actions import Action
from station.api.rosbridge.broker import (
    ANSWERED,
    Answer,
    ClientTopic,
    Offer,
)
from station.api.rosbridge.outbox import (
    COMPRESSIONS,
    LEVELS,
    TEXT_COMPRESSIONS,
    Form,
    Outbox,
    Publication,
    Subscription,
)
from station.api.rosbridge.ros_graph import RosGraph, path_of
from station.api.rosbridge.ros_types import (
    RosTypeError,
    checked,
    fields_of,
    filled,
    in_style,
    split_style,
    with_time,
)
from station.api.rosbridge.services import RosService
from station.api.rosbridge.topics import LATCHED, Topic
from station.api.streams.broadcaster import PORT
from station.api.tool_port import ToolClient, reason_of, report_fault
from station.core.errors import StationError
from station.records.cdr import Values

if TYPE_CHECKING:
    from station.api.streams.channel import StreamPort

MOST_SUBSCRIPTIONS = 200
"""Most topics to which a client may subscribe, and most subscriptions to each."""
MOST_QUEUED = 2000
"""Most messages in all queues of a client together."""
MOST_CALLS = 8
"""Most calls and goals of a client that begin at the same time, and most incomplete
messages."""
MOST_FRAGMENTS = 1000
"""Most parts of a message; together they have at most 1000 times as many characters."""
_ALIKE = 0.8
"""Similarity from which a name counts as a misspelling of another one."""
_LATEST = 2**53
"""Latest time in an authentication [s]."""
_AUTH_WINDOW = 5.0
"""Largest difference of the time in an authentication from the station's time [s]."""
# These operations run beside later messages, so that a stop never waits for a switch.
_LONG = frozenset({"call_service", "send_action_goal", "cancel_action_goal"})
_log = logging.getLogger(__name__)


class Message(dict[str, Any]):
    """A message of a client, which is refused when a field that it needs is missing.

    Args:
        data: JSON text.

    Raises:
        RosTypeError: The text is no JSON object, or names a field twice.
    """

    def __init__(self, data: str | bytes) -> None:
        text = data.encode() if isinstance(data, str) else data
        try:
            found = _read(text)
            # Refuse what cannot be passed on, such as half a character.
            written = orjson.dumps(found)
            # orjson keeps the last of two values of a key, so that fewer colons are
            # written, unless an escaped one makes up for it. Python's parser finds the
            # key, but takes ten times longer.
            if text.count(b":") != written.count(b":") or b"\\u" in text:
                check_names(text)
        except DoubleNameError as error:
            raise RosTypeError(
                f"The message {error}.", remedy="Give each key once."
            ) from error
        except (ValueError, TypeError) as error:
            raise RosTypeError(f"The message is not JSON: {error}.") from error
        if not isinstance(found, dict):
            raise RosTypeError("The message is not a JSON object.")
        super().__init__(found)

    def __missing__(self, key: str) -> object:
        raise RosTypeError(f"The message has no field '{key}'.")

    def text(self, key: str) -> str:
        """Return a text of the message.

        Raises:
            RosTypeError: The field is missing, or is not a text.
        """
        found = self[key]
        if not isinstance(found, str):
            raise RosTypeError(f"'{key}' is {found!r:.40}; it must be a text.")
        return found


class RosbridgeSession:
    """Serves one client, in the event loop of the API.

    The method `do_OP` carries out the operation OP of the protocol.

    Args:
        client: The client, with its rights.
        graph: Topics, services and actions for the client.
        half_tick: Half the time between two ticks [s].

    Attributes:
        outbox: Queue of messages to the client.
    """

    def __init__(self, client: ToolClient, graph: RosGraph, half_tick: float) -> None:
        self._port: StreamPort = client.websocket.scope["state"][PORT]
        self.outbox = Outbox(self._port, half_tick)
        self._client = client
        self._graph = graph
        self._fragments: dict[str, dict[int, str]] = {}
        self._calls: set[asyncio.Task[None]] = set()
        self._goals: dict[str, Callable[[], Awaitable[None]]] = {}
        self._proofs: set[str] = set()

    async def greet(self) -> None:
        """Prepare the connection; the client sends the first message."""
        self._port.listen(self.outbox.resume)

    async def feed(self, _: float) -> None:
        """Return once too many answers wait; surplus messages of topics are dropped."""
        await self.outbox.overflown.wait()

    async def listen(self) -> None:
        """Answer the client's messages; return when the client has left."""
        try:
            while True:
                message = await self._client.websocket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                text = message.get("text")
                await self._take(message.get("bytes") or b"" if text is None else text)
        finally:
            self._port.listen(None)
            self._graph.broker.leave(self.outbox)
            for call in self._calls:
                call.cancel()

    async def _take(self, data: str | bytes) -> None:
        """Carry out a message, or report its fault to the client."""
        with self._told(None):
            message = Message(data)
            with self._told(message.get("id")):
                await self._begin(message)

    async def _begin(self, message: Message) -> None:
        """Carry out a message, or start a task for it if it may take long.

        Raises:
            RosTypeError: There is no such operation, or too many are under way.
        """
        op = str(message["op"])
        carry_out = getattr(self, f"do_{op}", None)
        if carry_out is None:
            raise RosTypeError(f"There is no operation '{op:.40}'.")
        if op not in _LONG:
            await carry_out(message)
            return
        if len(self._calls) >= MOST_CALLS:
            raise RosTypeError(f"'{op}' has to wait: {MOST_CALLS} are under way.")
        task = asyncio.create_task(carry_out(message))
        self._calls.add(task)
        task.add_done_callback(self._calls.discard)

    @contextmanager
    def _told(
        self, identifier: object, answer: Callable[[str], None] = lambda _: None
    ) -> Iterator[None]:
        """Report a refusal in the body of a `with` to the client.

        Args:
            identifier: Identifier of the client's message; None without one.
            answer: Function that also sends the reason as the answer for which the
                client waits.
        """
        try:
            yield
        except StationError as error:
            why = reason_of(error)
        except RecursionError:
            why = "The message is nested too deeply."
        except Exception as error:  # noqa: BLE001 - a fault of the station, not of the client
            why = report_fault(error)
        else:
            return
        is_named = isinstance(identifier, str | int)
        self.outbox.tell("error", why, identifier if is_named else None)
        answer(why)

    def _topic(self, message: Message, *, opens: bool = False) -> Topic:
        """Return a topic; a message with a type may open a new topic of clients.

        Raises:
            RosTypeError: The topic is unknown, or it has another type, or its name is
                one of the station's.
        """
        name, kind = path_of(message.text("topic")), str(message.get("type") or "")
        try:
            found: Topic = self._graph.find("topics", name, kind)
        except RosTypeError as error:
            if not opens or not kind or name in self._graph.topics:
                raise
            if self._graph.broker.is_reserved(name):
                raise RosTypeError(
                    error.message,
                    remedy=f"{error.remedy} It would be a name of the station; choose "
                    "another first part for a topic of clients.",
                ) from error
            near = get_close_matches(name, self._graph.topics, 1, _ALIKE)
            found = self._graph.broker.open_topic(name, kind)
            # A client that comes before the publisher is usually right, and roslibpy
            # logs a status as a fault, so warn only if a similar topic exists.
            if message["op"] == "subscribe" and near:
                told = f"Nobody publishes '{name}' yet. {error.remedy}"
                self.outbox.tell("warning", told.strip())
        return found

    async def do_status(self, message: Message) -> None:
        """Note a status of the client in the log."""
        _log.debug("a client of rosbridge says: %.200s", message)

    async def do_set_level(self, message: Message) -> None:
        """Choose the level of the statuses that the client gets.

        Raises:
            RosTypeError: There is no such level.
        """
        if message["level"] not in LEVELS:
            raise RosTypeError(
                f"There is no level '{message['level']!s:.40}'.",
                remedy=f"Use one of {', '.join(LEVELS)}.",
            )
        self.outbox.level = message["level"]

    async def do_advertise(self, message: Message) -> None:
        """Publish to a topic from now on."""
        topic = self._writable(message)
        if isinstance(topic, ClientTopic):
            topic.is_latching |= bool(message.get("latch"))

    def _writable(self, message: Message) -> Topic:
        """Return a topic to which clients may publish.

        Raises:
            RosTypeError: Clients may not publish to the topic.
        """
        topic = self._topic(message, opens=message["op"] == "advertise")
        if topic.write is None:
            known = [n for n, one in self._graph.topics.items() if one.write]
            raise RosTypeError(
                f"Clients cannot publish to '{topic.name}'.",
                remedy=f"They can publish to {', '.join(known) or 'nothing'}.",
            )
        if isinstance(topic, ClientTopic):
            self._graph.broker.advertise(topic, self.outbox)
        return topic

    async def do_publish(self, message: Message) -> None:
        """Pass a message to its topic."""
        topic = self._writable(message)
        values = checked(topic.type, message.get("msg"))
        if isinstance(topic, ClientTopic):
            now = self._graph.clock.now()
            values = with_time(topic.type, message.get("msg"), values, now)
            is_latched = topic.is_latching or message.get("latch")
            topic.latched = values if is_latched else topic.latched
        with self._client.changing(
            f"publish {topic.name}", changes=topic.changes, free=1
        ):
            await self._run(topic.write, topic.blocks, values)

    async def do_unadvertise(self, message: Message) -> None:
        """End the publication to a topic."""
        name = path_of(message.text("topic"))
        self._graph.broker.leave_topic(name, self.outbox, "publishers")

    async def do_advertise_service(self, message: Message) -> None:
        """Offer a service or an action to the other clients."""
        kind = message["op"].rpartition("_")[2]
        name, type_name = message.text(kind), message.text("type")
        found = self._graph.broker.offer(f"{kind}s", name, type_name, self.outbox)
        self._client.record(f"offer of {found.name}", "done", is_done=True, free=1)

    async def do_unadvertise_service(self, message: Message) -> None:
        """Withdraw a service or an action."""
        kind = message["op"].rpartition("_")[2]
        self._graph.broker.take_back(f"{kind}s", message.text(kind), self.outbox)

    async def do_service_response(self, message: Message) -> None:
        """Pass on the answer to a call or a goal of another client."""
        self._graph.broker.hear(message, self.outbox)

    do_advertise_action = do_advertise_service
    do_unadvertise_action = do_unadvertise_service
    do_action_feedback = do_action_result = do_service_response

    async def _run(self, function: Any, blocks: bool, values: Values) -> Any:  # noqa: ANN401, FBT001 - any function's
        """Call a function with values of the client; in a thread if it may block."""
        if blocks:
            return await self._graph.goals.in_thread(function, self._client, values)
        found = function(self._client, values)
        return await found if inspect.isawaitable(found) else found

    async def do_subscribe(self, message: Message) -> None:
        """Subscribe to a topic.

        Raises:
            RosTypeError: The client has too many subscriptions, or an option is not
                allowed.
        """
        name, identifier = path_of(message.text("topic")), str(message.get("id"))
        form = _form_of(message, message.get("type"), COMPRESSIONS)
        throttle = _number(message, "throttle_rate", 3_600_000) / 1e3
        length = _number(message, "queue_length", MOST_QUEUED)
        found = self.outbox.subscriptions
        one = found.get(name) or Subscription()
        if max(len(found), len(one.wishes)) >= MOST_SUBSCRIPTIONS:
            raise RosTypeError(f"There are {MOST_SUBSCRIPTIONS} subscriptions already.")
        others = sum(s.length for other, s in found.items() if other != name)
        if others + length > MOST_QUEUED:
            raise RosTypeError(
                f"The queues of a client hold {MOST_QUEUED} messages together; those "
                f"of its other topics hold {others}."
            )
        topic = self._topic(message, opens=True)
        if form.compression == "cbor-raw" and not fields_of(topic.type):
            self._graph.broker.leave_topic(name, self.outbox)
            raise RosTypeError(
                f"The station does not know {topic.type}, so it has no bytes for it.",
                remedy="Use the compression cbor.",
            )
        if isinstance(topic, ClientTopic):
            topic.subscribers.add(self.outbox)
        one.wishes.pop(identifier, None)
        one.wishes[identifier] = (throttle, length, form)
        one.settle()
        found[name] = one
        frame = self._graph.clock.frame()
        if topic.period == LATCHED and topic.read and frame is not None:
            values = topic.read(frame)
            if values is not None:
                latched = Publication(topic.name, topic.type, values, frame.stamp)
                self.outbox.offer(latched, asyncio.get_running_loop().time())

    async def do_unsubscribe(self, message: Message) -> None:
        """End a subscription to a topic, or all of them."""
        topic, identifier = path_of(message.text("topic")), message.get("id")
        one = self.outbox.subscriptions.get(topic)
        if one is None:
            return
        one.wishes.pop(str(identifier), None)
        if identifier is None or not one.wishes:
            del self.outbox.subscriptions[topic]
            self._graph.broker.leave_topic(topic, self.outbox, "subscribers")
        else:
            one.settle()

    async def do_call_service(self, message: Message) -> None:
        """Call a service and answer with its response."""
        written, form = message.get("service"), Form()
        # Old clients write the identifier behind the name.
        name, _, old = str(written).partition("#")
        identifier = message.get("id", old or None)

        def answer(values: object, *, result: bool = False) -> None:
            head = {"op": "service_response", "service": written, "result": result}
            self.outbox.answer({**head, "values": values}, identifier, form)

        with self._told(identifier, answer):
            message.text("service")
            form = _form_of(message, message.get("type"), TEXT_COMPRESSIONS)
            service: RosService | Offer = self._graph.find("services", name)
            args = _named(service.type, message.get("args"))
            if isinstance(service, Offer):
                response = await self._graph.broker.call(service, args, self.outbox)
            else:
                response = await self._response(service, args)
            kind = f"{service.type}Response"
            answer(in_style(kind, response, ros2=form.is_ros2), result=True)

    async def _response(self, service: RosService, args: object) -> Values:
        """Return the response of a service.

        Raises:
            RosTypeError: The request is malformed.
            StationError: The request is refused, and the response has no field for a
                refusal.
        """
        kind, response = f"{service.type}Request", f"{service.type}Response"
        request = checked(kind, args, "args")
        what = f"call {service.name}"
        changes = service.changes and not service.is_free(self._client, request)
        if changes:
            self._client.check(what)
        try:
            with self._client.changing(what, changes=changes):
                found = await self._run(service.call, service.blocks, request)
        except RosTypeError:
            raise
        except StationError as error:
            if not _SUCCEEDED.keys() & fields_of(response).keys():
                raise
            why = reason_of(error)
            self.outbox.tell("error", why)
            found = {"ok": False, "success": False, "error": why, "message": why}
        return filled(response, _SUCCEEDED | dict(found or {}))

    async def do_send_action_goal(self, message: Message) -> None:
        """Send a goal in the way of ROS 2; its feedback and its result follow."""
        name, identifier = str(message.get("action")), message.get("id")
        goal_id, form = str(identifier), Form()

        def hear(found: Answer) -> None:
            part, values = ANSWERED[found.op], found.values
            if found.result:
                values = in_style(f"{action.type}{part}", values, ros2=form.is_ros2)
            answer = {"op": found.op, "action": name, "values": values}
            if part == "Result":
                self._goals.pop(goal_id, None)
                answer |= {"status": found.status, "result": found.result}
            elif not message.get("feedback"):
                return
            self.outbox.answer(answer, identifier, form)

        with self._told(identifier, lambda why: hear(Answer("action_result", why))):
            # The operation belongs to ROS 2, but the type may have the style of ROS 1.
            kind = message.get("action_type")
            form = _form_of(message, kind or "/action/", TEXT_COMPRESSIONS)
            message.text("action")
            action: Action | Offer = self._graph.find("actions", name, str(kind or ""))
            broker, args = self._graph.broker, message.get("args")
            if isinstance(action, Offer):
                number = broker.ask(action, args, self.outbox, hear)
                self._goals[goal_id] = partial(broker.cancel, number)
                return
            goal = checked(f"{action.type}Goal", args, "args")
            stamped = checked("actionlib_msgs/GoalID", {"id": goal_id})
            self._goals[goal_id] = partial(self._cancel_own, action, goal_id)
            with self._client.changing(f"goal of {name}", changes=action.changes):
                await self._graph.goals.start(action, self._client, goal, stamped, hear)

    async def do_cancel_action_goal(self, message: Message) -> None:
        """Cancel a goal that the client has sent."""
        with self._told(message.get("id")):
            await self._cancel_of(str(message["id"]))()

    def _cancel_of(self, identifier: str) -> Callable[[], Awaitable[None]]:
        """Return the function that cancels a goal of the client.

        Raises:
            RosTypeError: The client has no such goal.
        """
        found = self._goals.get(identifier)
        if found is None:
            raise RosTypeError(f"There is no goal '{identifier:.80}'.")
        return found

    async def _cancel_own(self, action: Action, identifier: str) -> None:
        with self._client.changing(f"cancel of {action.name}", changes=action.changes):
            await self._graph.goals.cancel(action, identifier)

    async def do_fragment(self, message: Message) -> None:
        """Collect the parts of a message.

        Raises:
            RosTypeError: The message has too many parts.
        """
        name, total = str(message["id"]), _number(message, "total", MOST_FRAGMENTS, 1)
        number = _number(message, "num", total - 1)
        parts = self._fragments.setdefault(name, {})
        parts[number] = str(message["data"])
        size = sum(len(p) for found in self._fragments.values() for p in found.values())
        if size > 1000 * MOST_FRAGMENTS or len(self._fragments) > MOST_CALLS:
            self._fragments.clear()
            raise RosTypeError("Too many fragments wait for others; all are forgotten.")
        if len(parts) == total:
            del self._fragments[name]
            await self._take("".join(parts[k] for k in range(total)))

    async def do_auth(self, message: Message) -> None:
        """Give the client the rights of the token with which a MAC was made.

        Source: GT-RAIL/rosauth, ros_mac_authentication.cpp: SHA-512 over the secret
        and the fields of the message.

        Raises:
            RosTypeError: The MAC was not made with a token of the station, or was used
                before.
        """
        keys = ("client", "dest", "rand", "t", "level", "end")
        text = "".join(str(message[key]) for key in keys)
        services, proof = self._client.services, str(message["mac"])
        authenticator = services.authenticator
        made, end = (_number(message, key, _LATEST) for key in ("t", "end"))
        now = time.time()
        is_new = abs(now - made) <= _AUTH_WINDOW and (not end or now < end)
        for token, role in (
            (authenticator.operator_token, Role.OPERATOR),
            (authenticator.viewer_token, Role.VIEWER),
        ):
            digest = hashlib.sha512(f"{token}{text}".encode()).hexdigest()
            fits = hmac.compare_digest(digest.encode(), proof.encode())
            if fits and is_new and proof not in self._proofs:
                self._proofs.add(proof)
                self._client.access = Access(role)
                return
        services.event_recorder.failed_login(self._client.websocket)
        await services.failed_logins.slow_down(self._client.websocket)
        raise RosTypeError(
            "The authentication fits no token of this station, or comes too late.",
            remedy="Make the MAC with the operator's or the viewer's token, at once.",
        )


_SUCCEEDED: Values = {"ok": True, "success": True}


def _named(type_name: str, args: object) -> object:
    """Return arguments by name; the protocol may also list them in order."""
    if not isinstance(args, list):
        return args
    is_whole = len(args) == 1 and isinstance(args[0], dict)
    fields = fields_of(f"{type_name}Request")
    return args[0] if is_whole else dict(zip(fields, args, strict=False))


def _form_of(
    message: Message, type_name: object, compressions: tuple[str, ...]
) -> Form:
    """Return the form in which a client wants messages.

    Raises:
        RosTypeError: The compression is unknown.
    """
    compression = message.get("compression") or "none"
    if compression not in compressions:
        raise RosTypeError(
            f"There is no compression '{compression!s:.40}'; use "
            f"{', '.join(compressions)}."
        )
    size = _number(message, "fragment_size", 2**31)
    # A frame has about 100 characters around its part of the message.
    size = max(size, 100) if size else 0
    is_ros2 = split_style(str(type_name or ""))[1]
    return Form(compression, is_ros2, size, str(message.get("topic") or ""))


def _read(text: bytes) -> object:
    """Parse JSON, which may have NaN and Infinity, as Python writes them.

    A field that may not have them is refused by its name.

    Raises:
        ValueError: The text is no JSON in other places, too.
    """
    try:
        return orjson.loads(text)
    except ValueError:
        if b"NaN" in text or b"Infinity" in text:
            return json.loads(text)
        raise


def _number(message: Message, key: str, most: int, least: int = 0) -> int:
    """Return a whole number of a message; 0 without one.

    Raises:
        RosTypeError: The value is not a number, or out of range.
    """
    value = message.get(key) or 0
    if not isinstance(value, int | float) or not least <= value <= most:
        raise RosTypeError(f"'{key}' is {value!r:.40}; allowed are {least} to {most}.")
    return int(value)
