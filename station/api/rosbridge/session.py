"""One client of rosbridge: what it subscribes to, publishes, calls and asks for.

Source: RobotWebTools/rosbridge_suite ROSBRIDGE_PROTOCOL.md and rosbridge_library's
capabilities; differs: clients offer no topics, services and actions of their own.
"""

import asyncio
import hashlib
import hmac
import inspect
import logging
import time
from collections.abc import Callable, Coroutine, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import anyio.to_thread
import orjson

from station.api.auth import Access, Role
from station.api.rosbridge.actions import ROS2, Action, Progress
from station.api.rosbridge.outbox import LEVELS, Outbox, Subscription
from station.api.rosbridge.publication import COMPRESSIONS, Form, Publication
from station.api.rosbridge.ros_graph import RosGraph
from station.api.rosbridge.ros_types import (
    RosTypeError,
    as_ros1,
    checked,
    field_names,
    filled,
    split_style,
)
from station.api.rosbridge.services import RosService
from station.api.rosbridge.topics import LATCHED, Topic
from station.api.streams.broadcaster import PORT
from station.api.tool_port import ToolClient
from station.core.errors import StationError
from station.core.ports.goal import GoalStatus
from station.records.cdr import Values

if TYPE_CHECKING:
    from station.api.streams.stream_client import StreamPort

MOST_SUBSCRIPTIONS = 200
"""Most topics that a client subscribes to, and most subscriptions to each."""
MOST_QUEUED = 2000
"""Most messages in all queues of a client together."""
MOST_CALLS = 8
"""Most services and goals of a client that begin at a time, and most messages of which
parts are missing."""
MOST_FRAGMENTS = 1000
"""Most parts of a message; together they have at most so many thousand characters."""
_AUTH_WINDOW = 5.0
"""How far the time of an authentication may be from the station's [s]."""
_REFUSED = frozenset({
    "advertise_service", "unadvertise_service", "service_response", "advertise_action",
    "unadvertise_action", "action_feedback", "action_result",
})  # fmt: skip
# They go on beside the messages that follow: a stop never waits for a switch.
_LONG = frozenset({"call_service", "send_action_goal", "cancel_action_goal"})
# What clients send that does not keep to the protocol.
_NO_MESSAGE = (ValueError, TypeError, AttributeError, LookupError, RecursionError)
_log = logging.getLogger(__name__)
Message = Mapping[str, Any]


class RosbridgeSession:
    """Talks to one client, in the event loop of the API.

    Args:
        client: The client, and what it may change.
        graph: What it reaches.
        half_tick: Half the time between two ticks [s].

    Attributes:
        outbox: What is on its way to the client.
    """

    def __init__(self, client: ToolClient, graph: RosGraph, half_tick: float) -> None:
        self._port: StreamPort = client.websocket.scope["state"][PORT]
        self.outbox = Outbox(self._port, half_tick)
        self._client = client
        self._graph = graph
        self._fragments: dict[str, dict[int, str]] = {}
        self._calls: set[asyncio.Task[None]] = set()
        self._goals: dict[str, Action] = {}
        self._proofs: set[str] = set()
        self._operations: dict[str, Callable[[Message], Coroutine[Any, Any, None]]] = {
            "advertise": self._advertise,
            "unadvertise": self._ignore,
            "publish": self._publish,
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "call_service": self._call,
            "send_action_goal": self._send_goal,
            "cancel_action_goal": self._cancel_goal,
            "fragment": self._defragment,
            "set_level": self._set_level,
            "auth": self._authenticate,
            "status": self._ignore,
        }

    async def greet(self) -> None:
        """Begin; the client speaks first."""
        self._port.listen(self.outbox.resume)

    async def feed(self, _: float) -> None:
        """Wait until too many answers wait; slow subscribers lose messages instead."""
        await self.outbox.overflown.wait()

    async def listen(self) -> None:
        """Answer what the client asks; return when it is gone."""
        try:
            while True:
                message = await self._client.websocket.receive()
                if message["type"] == "websocket.disconnect":
                    return
                text = message.get("text")
                await self._take(message.get("bytes") or b"" if text is None else text)
        finally:
            self._port.listen(None)
            for call in self._calls:
                call.cancel()

    async def _take(self, data: str | bytes) -> None:
        """Carry a message out, or say what is wrong with it.

        Raises:
            RosTypeError: Never; the client is told.
        """
        found: list[object] = [None]
        with self._told(found):
            message = orjson.loads(data)
            found[0] = message.get("id")
            op = str(message["op"])
            if op in _REFUSED:
                raise RosTypeError(
                    f"'{op}' is not possible: clients offer nothing to this station.",
                    remedy="Load a controller instead.",
                )
            if op not in self._operations:
                raise RosTypeError(f"There is no operation '{op:.40}'.")
            if op not in _LONG:
                await self._operations[op](message)
                return
            if len(self._calls) >= MOST_CALLS:
                raise RosTypeError(f"'{op}' has to wait: {MOST_CALLS} are under way.")
            task = asyncio.create_task(self._operations[op](message))
            self._calls.add(task)
            task.add_done_callback(self._finished)

    def _finished(self, call: asyncio.Task[None]) -> None:
        self._calls.discard(call)
        if not call.cancelled() and (error := call.exception()) is not None:
            _log.error("a call of a client of rosbridge failed", exc_info=error)
            self.outbox.tell("error", "The station has failed; see its log.")

    @contextmanager
    def _told(
        self, identifier: list[object], answer: Callable[[str], None] | None = None
    ) -> Iterator[None]:
        """Tell the client of what is refused in the body of a `with`.

        Args:
            identifier: Of the message, once it is known.
            answer: Sends a reason as the answer that the client waits for, too.
        """
        try:
            yield
        except StationError as error:
            why = _reason(error)
        except _NO_MESSAGE as error:
            why = f"That is no message of rosbridge: {type(error).__name__}: {error}."
        else:
            return
        one = identifier[0]
        self.outbox.tell("error", why, one if isinstance(one, str | int) else None)
        if answer is not None:
            answer(why)

    def _topic(self, message: Message) -> Topic:
        kind = message.get("type") or ""
        found: Topic = self._graph.find("topics", str(message["topic"]), str(kind))
        return found

    async def _ignore(self, message: Message) -> None:
        _log.debug("a client of rosbridge says: %.200s", message)

    async def _set_level(self, message: Message) -> None:
        self.outbox.level = LEVELS[LEVELS.index(message["level"])]

    async def _advertise(self, message: Message) -> None:
        """Check that clients may publish to a topic.

        Raises:
            RosTypeError: They may not.
        """
        topic = self._topic(message)
        if topic.write is None:
            known = [n for n, one in self._graph.topics.items() if one.write]
            raise RosTypeError(
                f"Clients cannot publish to '{topic.name}'.",
                remedy=f"They can publish to {', '.join(known) or 'nothing'}.",
            )

    async def _publish(self, message: Message) -> None:
        await self._advertise(message)
        topic = self._topic(message)
        values = checked(topic.type, message.get("msg"))
        with self._recorded(f"publish {topic.name}", free=1):
            await self._run(topic.write, topic.is_quick, values)

    async def _run(self, function: Any, is_quick: bool, values: Values) -> Any:  # noqa: ANN401, FBT001 - any function's
        """Call a function with values of the client, in a thread unless it is quick."""
        if not is_quick:
            threads = self._graph.goals.threads
            return await anyio.to_thread.run_sync(
                function, self._client, values, limiter=threads
            )
        found = function(self._client, values)
        return await found if inspect.isawaitable(found) else found

    @contextmanager
    def _recorded(self, what: str, *, free: int = 10) -> Iterator[None]:
        """Check that the client may change something, and record how that ended.

        Args:
            what: The change.
            free: How many such events are recorded before they are counted.

        Raises:
            StationError: It may not, or the body of the `with` was refused.
        """
        self._client.check(what)
        try:
            yield
        except StationError as error:
            self._client.record(what, f"refused: {error.code}", is_done=False)
            raise
        self._client.record(what, "done", is_done=True, free=free)

    async def _subscribe(self, message: Message) -> None:
        """Subscribe to a topic.

        Raises:
            RosTypeError: The client has too many subscriptions, or a wish is wrong.
        """
        topic, identifier = self._topic(message), str(message.get("id"))
        form = _form_of(message, message.get("type"), COMPRESSIONS)
        form = form._replace(topic=str(message["topic"]))
        throttle = _number(message, "throttle_rate", 3_600_000) / 1e3
        length = _number(message, "queue_length", MOST_QUEUED)
        found = self.outbox.subscriptions
        one = found.get(topic.name) or Subscription()
        if max(len(found), len(one.wishes)) >= MOST_SUBSCRIPTIONS:
            raise RosTypeError(f"There are {MOST_SUBSCRIPTIONS} subscriptions already.")
        others = sum(s.length for name, s in found.items() if name != topic.name)
        if others + length > MOST_QUEUED:
            raise RosTypeError(
                f"The queues of a client hold {MOST_QUEUED} messages together; those "
                f"of its other topics hold {others}."
            )
        one.wishes.pop(identifier, None)
        one.wishes[identifier] = (throttle, length, form)
        one.settle()
        found[topic.name] = one
        frame = self._graph.clock.frame()
        if topic.period == LATCHED and topic.read and frame is not None:
            values = topic.read(frame) or {}
            latched = Publication(topic.name, topic.type, values, frame.stamp)
            self.outbox.offer(latched, asyncio.get_running_loop().time())

    async def _unsubscribe(self, message: Message) -> None:
        topic, identifier = f"/{str(message['topic']).strip('/')}", message.get("id")
        one = self.outbox.subscriptions.get(topic)
        if one is None:
            return
        one.wishes.pop(str(identifier), None)
        if identifier is None or not one.wishes:
            del self.outbox.subscriptions[topic]
        else:
            one.settle()

    async def _call(self, message: Message) -> None:
        """Call a service and answer with its response."""
        name, identifier = str(message.get("service")), message.get("id")
        form = Form()

        def answer(values: object, *, result: bool = False) -> None:
            head = {"op": "service_response", "service": name, "result": result}
            self.outbox.answer({**head, "values": values}, identifier, form)

        with self._told([identifier], answer):
            form = _form_of(message, message.get("type"), COMPRESSIONS[:2])
            service: RosService = self._graph.find("services", name)
            response = await self._response(service, message.get("args"))
            kind = f"{service.type}Response"
            answer(response if form.is_ros2 else as_ros1(kind, response), result=True)

    async def _response(self, service: RosService, args: object) -> Values:
        """Return the response of a service.

        Raises:
            RosTypeError: The request is malformed.
            StationError: It is refused, and the response has no field to say so.
        """
        kind, response = f"{service.type}Request", f"{service.type}Response"
        if isinstance(args, list):
            # The protocol's list has the arguments in the order of the request.
            is_whole = len(args) == 1 and isinstance(args[0], dict)
            named = dict(zip(field_names(kind), args, strict=False))
            args = args[0] if is_whole else named
        request = checked(kind, args, "args")
        if not service.changes:
            found = await self._run(service.call, service.is_quick, request)
            return filled(response, _SUCCEEDED | dict(found or {}), 0)
        self._client.check(f"call {service.name}")
        try:
            with self._recorded(f"call {service.name}"):
                found = await self._run(service.call, service.is_quick, request)
        except RosTypeError:
            raise
        except StationError as error:
            if not _SUCCEEDED.keys() & set(field_names(response)):
                raise
            why = _reason(error)
            self.outbox.tell("error", why)
            found = {"ok": False, "success": False, "error": why, "message": why}
        return filled(response, _SUCCEEDED | dict(found or {}), 0)

    async def _send_goal(self, message: Message) -> None:
        """Give a goal as ROS 2 has it; feedback and result follow."""
        name, identifier = str(message.get("action")), message.get("id")
        form = Form()

        def answer(op: str, values: object, **more: object) -> None:
            head = {"op": op, "action": name, "values": values}
            self.outbox.answer({**head, **more}, identifier, form)

        def refuse(why: str) -> None:
            self._goals.pop(str(identifier), None)
            answer("action_result", why, status=0, result=False)

        def told(progress: Progress) -> None:
            part = "Result" if progress.status in ROS2 else "Feedback"
            values = dict(progress.values)
            if not form.is_ros2:
                values = as_ros1(f"{action.type}{part}", values)
            if progress.status in ROS2:
                self._goals.pop(str(identifier), None)
                status = ROS2[progress.status]
                answer("action_result", values, status=status, result=True)
            elif message.get("feedback") and progress.status is GoalStatus.ACTIVE:
                answer("action_feedback", values)

        with self._told([identifier], refuse):
            # The operation is that of ROS 2; a type may say otherwise.
            kind = message.get("action_type")
            form = _form_of(message, kind or "/action/", COMPRESSIONS[:2])
            action: Action = self._graph.find("actions", name, str(kind or ""))
            goal = checked(f"{action.type}Goal", message.get("args"), "args")
            goal_id = checked("actionlib_msgs/GoalID", {"id": str(identifier)})
            self._goals[str(identifier)] = action
            with self._recorded(f"goal of {name}"):
                await self._graph.goals.start(action, self._client, goal, goal_id, told)

    async def _cancel_goal(self, message: Message) -> None:
        identifier = message.get("id")
        with self._told([identifier]):
            action = self._goals.get(str(identifier))
            if action is None:
                raise RosTypeError(f"There is no goal '{identifier!s:.80}'.")
            with self._recorded(f"cancel of {action.name}"):
                await self._graph.goals.cancel(action, str(identifier))

    async def _defragment(self, message: Message) -> None:
        """Collect the parts of a message.

        Raises:
            RosTypeError: There are too many.
        """
        name, total = str(message["id"]), _number(message, "total", MOST_FRAGMENTS)
        number = _number(message, "num", max(total - 1, 0))
        parts = self._fragments.setdefault(name, {})
        parts[number] = str(message["data"])
        size = sum(len(p) for found in self._fragments.values() for p in found.values())
        if size > 1000 * MOST_FRAGMENTS or len(self._fragments) > MOST_CALLS:
            self._fragments.clear()
            raise RosTypeError("Too many fragments wait for others; all are forgotten.")
        if len(parts) == total:
            del self._fragments[name]
            await self._take("".join(parts[k] for k in range(total)))

    async def _authenticate(self, message: Message) -> None:
        """Take the rights of the token that a MAC was made with.

        Source: GT-RAIL/rosauth, ros_mac_authentication.cpp: SHA-512 over the secret
        and the fields of the message.

        Raises:
            RosTypeError: It was made with no token of the station, or used before.
        """
        keys = ("client", "dest", "rand", "t", "level", "end")
        text = "".join(str(message[key]) for key in keys)
        services, proof = self._client.services, str(message["mac"])
        authenticator = services.authenticator
        now, end = time.time(), float(message["end"])
        is_new = abs(now - float(message["t"])) <= _AUTH_WINDOW and (
            not end or now < end
        )
        for token, role in (
            (authenticator.operator_token, Role.OPERATOR),
            (authenticator.viewer_token, Role.VIEWER),
        ):
            made = hashlib.sha512(f"{token}{text}".encode()).hexdigest()
            fits = hmac.compare_digest(made.encode(), proof.encode())
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


def _reason(error: StationError) -> str:
    return f"{error.message} {error.remedy}".strip()


def _form_of(
    message: Message, type_name: object, compressions: tuple[str, ...]
) -> Form:
    """Return the form in which a client wants its messages.

    Raises:
        RosTypeError: There is no such compression.
    """
    compression = message.get("compression") or "none"
    if compression not in compressions:
        raise RosTypeError(
            f"There is no compression '{compression!s:.40}'; use "
            f"{', '.join(compressions)}."
        )
    size = _number(message, "fragment_size", 2**31)
    # A frame has about 100 characters besides its part of the message.
    size = max(size, 100) if size else 0
    return Form(compression, split_style(str(type_name or ""))[1], size)


def _number(message: Message, key: str, most: int) -> int:
    """Return a whole number of a message; 0 without one.

    Raises:
        RosTypeError: It is none, or out of range.
    """
    value = message.get(key) or 0
    if not isinstance(value, int | float) or not 0 <= value <= most:
        raise RosTypeError(f"'{key}' is {value!r:.40}; allowed are 0 to {most}.")
    return int(value)
