"""One Foxglove client: its subscriptions, requests and changes.

Source: https://github.com/foxglove/ws-protocol, docs/spec.md; differs: clients publish
nothing, and there are no assets and no connection graph.
"""

import asyncio
import json
import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from sys import float_info
from typing import Any, TypeGuard, TypeVar

import anyio.to_thread
from starlette.websockets import WebSocket, WebSocketDisconnect

from station.api.foxglove.live_channels import LiveChannels, LiveMessage
from station.api.json_route import check_names
from station.api.tool_port import ToolClient, reason_of, report_fault
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    InvalidCommandError,
    InvalidGainError,
    StationError,
    suggest,
)
from station.records.cdr import MessageType

SWITCH_SERVICE = "/switch_controllers"
_SLASH = "/"
SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
MOST_SUBSCRIPTIONS = 1000
"""Most subscriptions of a client."""
_SERVICE_ID = 1
_MESSAGE, _SERVICE_CALL_OPCODE, _SERVICE_ANSWER = 1, 2, 3
_SERVICE_CALL = struct.Struct("<BIII")
"""Head of a call: opcode, service, call, length of the encoding's name."""
_DATA = struct.Struct("<BIQ")
_WARNING, _ERROR = 1, 2
# Errors that messages of clients cause if they violate the protocol.
_NO_MESSAGE = (
    ValueError, TypeError, AttributeError, LookupError, RecursionError, struct.error,
)  # fmt: skip
_In = TypeVar("_In")
_Out = TypeVar("_Out")


@dataclass(frozen=True, slots=True)
class GainsAnswer:
    """The result of a client's change of parameters.

    Attributes:
        values: Present values of the requested gains that exist.
        problems: Reasons for which gains were not set, one sentence each.
    """

    values: dict[str, float]
    problems: list[str]


class FoxgloveChanges:
    """The changes of one client. Its methods may block, so call them in worker threads.

    Args:
        client: The client, with its rights.
    """

    def __init__(self, client: ToolClient) -> None:
        self._client = client
        self._station = client.services.station

    def gains(self, names: list[str]) -> dict[str, float]:
        """Return gains by `controller/gain`; all if `names` is empty."""
        found = {
            f"{controller}{_SLASH}{name}": value
            for controller, values in self._station.tuning.all_gains().items()
            for name, value in values.items()
        }
        return {name: found[name] for name in names or found if name in found}

    def set_gains(self, wanted: dict[str, object]) -> GainsAnswer:
        """Set gains; valid values are set even if others are refused.

        Args:
            wanted: Values by `controller/gain`.
        """
        what = f"setParameters {', '.join(wanted)}"
        try:
            self._client.check(what)
        except StationError as error:
            return GainsAnswer(self.gains(list(wanted)), [reason_of(error)])
        problems: list[str] = []
        known, good = self.gains([]), {}
        for name, value in wanted.items():
            if name not in known:
                problems.append(f"There is no gain '{name}'. {suggest(name, known)}")
            elif not _is_double(value):
                problems.append(f"The gain '{name}' cannot be {value!r:.40}.")
            else:
                good[name] = float(value)
        problems += self._set(good)
        result = "done" if not problems else "refused: " + " ".join(problems)
        self._client.record(what, result, is_done=not problems)
        return GainsAnswer(self.gains(list(wanted)), problems)

    def switch(self, payload: bytes) -> bytes:
        """Start and stop controllers; return the answer as JSON.

        Args:
            payload: JSON with lists of names, `start` and `stop`.

        Raises:
            StationError: The change is refused.
            InvalidCommandError: The switch failed; the same controllers run as before.
            ValueError: The payload is not JSON.
            RecursionError: The payload is too deeply nested.
        """
        self._client.check(SWITCH_SERVICE)
        try:
            asked = check_names(payload)
            start, stop = _names(asked, "start"), _names(asked, "stop")
            result = self._station.switch_controllers(SwitchRequest(start, stop))
        except (StationError, ValueError, RecursionError) as error:
            self._client.record(SWITCH_SERVICE, f"refused: {error}", is_done=False)
            raise
        self._client.services.event_recorder.switch(self._client.websocket, result)
        ended = "done" if result.ok else "failed"
        self._client.record(SWITCH_SERVICE, ended, is_done=result.ok)
        if not result.ok:
            failed = (f"{name}: {why}" for name, why in result.failed.items())
            raise InvalidCommandError(
                f"The switch was {result.outcome.name.lower()}. {' '.join(failed)}"
            )
        return json.dumps({"ok": True, "message": ""}).encode()

    def _set(self, good: dict[str, float]) -> list[str]:
        """Set gains that exist; return the reasons for those that could not be set."""
        if not good:
            return []
        try:
            self._station.tuning.set_many(_by_controller(good))
        except InvalidGainError as error:
            if len(good) == 1:
                return [reason_of(error)]
            # Set them one by one, so that a wrong value does not keep the others from
            # being set.
            return [
                one for name, value in good.items() for one in self._set({name: value})
            ]
        except StationError as error:
            return [reason_of(error)]
        return []


def _by_controller(gains: dict[str, float]) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for name, value in gains.items():
        controller, _, gain = name.partition(_SLASH)
        found.setdefault(controller, {})[gain] = value
    return found


def _names(asked: object, key: str) -> list[str]:
    """Return a list of names of a request.

    Raises:
        InvalidCommandError: The names are not a list of strings.
    """
    names = asked.get(key, []) if isinstance(asked, dict) else None
    if isinstance(names, list) and all(isinstance(one, str) for one in names):
        return names
    raise InvalidCommandError(
        f"'{key}' is no list of names of controllers.",
        remedy='Send {"start": ["arm"], "stop": []}.',
    )


def _is_double(value: object) -> TypeGuard[float]:
    """Return whether JSON has a number here, and not one beyond all doubles."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return not isinstance(value, int) or abs(value) <= float_info.max


class FoxgloveSession:
    """Serves one client, in the event loop of the API.

    Args:
        websocket: The accepted connection.
        channels: Channels that a client can subscribe to.
        changes: Carries out the changes that the client requests.
        numbers: Numbers of the channels by topic, which all clients share; a session
            adds new channels.
    """

    def __init__(
        self,
        websocket: WebSocket,
        channels: LiveChannels,
        changes: FoxgloveChanges,
        numbers: dict[str, int],
    ) -> None:
        self._websocket = websocket
        self._channels = channels
        self._changes = changes
        self._numbers = numbers
        self._advertised: set[str] = set()
        self._subscriptions: dict[int, str] = {}
        self._texts_due: dict[int, str] = {}
        self._watched: set[str] = set()
        self._values: dict[str, float] = {}
        self._newest: list[LiveMessage] = []
        self._wake = asyncio.Event()

    @property
    def topics(self) -> set[str]:
        """The channels that the client has subscribed to."""
        return set(self._subscriptions.values())

    def offer(self, messages: list[LiveMessage]) -> None:
        """Offer the messages of the newest cycle; a slow client misses older ones."""
        self._newest = messages
        self._wake.set()

    async def greet(self) -> None:
        """Advertise the channels, the services and the parameters."""
        await self._send({
            "op": "serverInfo",
            "name": "control station",
            "capabilities": ["parameters", "parametersSubscribe", "services"],
            "supportedEncodings": ["json"],
            "metadata": {},
            "sessionId": self._channels.boot_id,
        })
        await self._advertise()
        await self._send({"op": "advertiseServices", "services": [_service()]})

    async def feed(self, slow_after: float) -> None:
        """Send the offered frames; return if the client reads none for too long.

        Args:
            slow_after: Longest time without reading [s].
        """
        while True:
            await self._wake.wait()
            self._wake.clear()
            try:
                async with asyncio.timeout(slow_after):
                    await self._send_newest()
            except TimeoutError:
                return

    async def listen(self) -> None:
        """Answer the client's requests; return when the client has left."""
        while True:
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            try:
                text, data = message.get("text"), message.get("bytes")
                if text is not None:
                    await self._take_text(text)
                elif data:
                    await self._take_call(data)
            except WebSocketDisconnect:
                return
            except StationFaultError as fault:
                await self._tell(_ERROR, str(fault))
            except _NO_MESSAGE as error:
                await self._tell(_ERROR, f"That is no message of Foxglove: {error!r}.")

    async def watch_parameters(self) -> None:
        """Send the gains that have changed since the last call, if subscribed."""
        if not self._watched:
            return
        found = await _run(self._changes.gains, [*self._watched])
        changed = {n: v for n, v in found.items() if self._values.get(n) != v}
        self._values = found
        if changed:
            await self._send(_parameter_values(changed))

    async def _send_newest(self) -> None:
        await self._advertise()
        numbers: dict[str, list[int]] = {}
        for number, topic in self._subscriptions.items():
            numbers.setdefault(topic, []).append(number)
        messages, self._newest = self._newest, []
        for message in messages:
            for number in numbers.get(message.topic, ()):
                await self._send_data(number, message)
        while self._texts_due:
            number, topic = self._texts_due.popitem()
            text = self._channels.text(topic)
            if text is not None:
                await self._send_data(number, text)

    async def _send_data(self, number: int, message: LiveMessage) -> None:
        head = _DATA.pack(_MESSAGE, number, message.stamp)
        await self._websocket.send_bytes(head + message.data)

    async def _advertise(self) -> None:
        """Advertise channels that the client does not know yet."""
        new = [t for t in self._channels.kinds if t not in self._advertised]
        if not new:
            return
        for topic in new:
            self._numbers.setdefault(topic, len(self._numbers) + 1)
        self._advertised.update(new)
        kinds = self._channels.kinds
        channels = [_channel(self._numbers[t], t, kinds[t]) for t in new]
        await self._send({"op": "advertise", "channels": channels})

    async def _take_text(self, text: str) -> None:
        asked = check_names(text)
        op = asked["op"]
        if op == "subscribe":
            await self._subscribe(asked["subscriptions"])
        elif op == "unsubscribe":
            for number in asked["subscriptionIds"]:
                self._subscriptions.pop(number, None)
                self._texts_due.pop(number, None)
        elif op == "getParameters":
            names = [str(one) for one in asked.get("parameterNames", [])]
            found = await _run(self._changes.gains, names)
            await self._send(_parameter_values(found, asked.get("id")))
        elif op == "setParameters":
            await self._set_parameters(asked["parameters"], asked.get("id"))
        elif op == "subscribeParameterUpdates":
            names = [str(one) for one in asked.get("parameterNames", [])]
            found = await _run(self._changes.gains, names)
            self._watched.update(found)
            self._values.update(found)
        elif op == "unsubscribeParameterUpdates":
            names = asked.get("parameterNames") or [*self._watched]
            self._watched.difference_update(names)
        else:
            await self._tell(_WARNING, f"This station does not do {op!r:.40}.")

    async def _subscribe(self, wanted: Iterable[Mapping[str, Any]]) -> None:
        topics = {number: topic for topic, number in self._numbers.items()}
        for one in wanted:
            number, topic = int(one["id"]), topics.get(one["channelId"])
            if topic is None or len(self._subscriptions) >= MOST_SUBSCRIPTIONS:
                why = f"Channel {one['channelId']!r:.40} cannot be subscribed to."
                await self._tell(_ERROR, why)
            elif 0 <= number < 2**32:
                self._subscriptions[number] = topic
                self._texts_due[number] = topic

    async def _set_parameters(
        self, parameters: Iterable[Mapping[str, Any]], request: str | None
    ) -> None:
        wanted = {str(one["name"]): one.get("value") for one in parameters}
        answer = await _run(self._changes.set_gains, wanted)
        for problem in answer.problems:
            await self._tell(_ERROR, problem)
        await self._send(_parameter_values(answer.values, request))

    async def _take_call(self, data: bytes) -> None:
        """Call a service, and report even a failure to the client."""
        opcode, service, call, length = _SERVICE_CALL.unpack_from(data)
        if opcode != _SERVICE_CALL_OPCODE:
            await self._tell(_WARNING, "Clients publish nothing to this station.")
            return
        encoding = data[_SERVICE_CALL.size : _SERVICE_CALL.size + length]
        failure = {"op": "serviceCallFailure", "serviceId": service, "callId": call}
        if service != _SERVICE_ID or encoding != b"json":
            why = "There is no such service, or not in that encoding."
            await self._send({**failure, "message": why})
            return
        payload = data[_SERVICE_CALL.size + length :]
        try:
            answer = await _run(self._changes.switch, payload)
        except (StationError, ValueError, RecursionError, StationFaultError) as error:
            why = str(error) or type(error).__name__
            await self._send({**failure, "message": why})
            return
        head = _SERVICE_CALL.pack(_SERVICE_ANSWER, service, call, len(encoding))
        await self._websocket.send_bytes(head + encoding + answer)

    async def _tell(self, level: int, message: str) -> None:
        await self._send({"op": "status", "level": level, "message": message[:500]})

    async def _send(self, message: dict[str, object]) -> None:
        await self._websocket.send_text(json.dumps(message))


class StationFaultError(Exception):
    """The station failed unexpectedly in carrying out a message."""


async def _run(function: Callable[[_In], _Out], value: _In) -> _Out:
    """Call a function of the station in a thread.

    Raises:
        StationError: It refuses the value.
        ValueError: The value is malformed.
        RecursionError: The value is nested too deeply.
        StationFaultError: It failed for another reason.
    """
    try:
        return await anyio.to_thread.run_sync(function, value)
    except (StationError, ValueError, RecursionError):
        raise
    except Exception as error:
        raise StationFaultError(report_fault(error)) from error


def _channel(number: int, topic: str, kind: MessageType) -> dict[str, object]:
    return {
        "id": number,
        "topic": topic,
        "encoding": "cdr",
        "schemaName": kind.name,
        "schemaEncoding": "ros2msg",
        "schema": kind.text,
    }


def _parameter_values(
    values: dict[str, float], request: str | None = None
) -> dict[str, object]:
    found: dict[str, object] = {
        "op": "parameterValues",
        "parameters": [
            {"name": name, "value": value, "type": "float64"}
            for name, value in values.items()
        ],
    }
    return found if request is None else {**found, "id": request}


def _service() -> dict[str, object]:
    """Return the description of the service that switches controllers."""
    names = {"type": "array", "items": {"type": "string"}}
    request = {"type": "object", "properties": {"start": names, "stop": names}}
    answer = {
        "type": "object",
        "properties": {"ok": {"type": "boolean"}, "message": {"type": "string"}},
    }

    def side(name: str, schema: Mapping[str, object]) -> dict[str, str]:
        return {
            "encoding": "json",
            "schemaName": name,
            "schemaEncoding": "jsonschema",
            "schema": json.dumps(schema),
        }

    return {
        "id": _SERVICE_ID,
        "name": SWITCH_SERVICE,
        "type": "control_station/SwitchControllers",
        "request": side("SwitchRequest", request),
        "response": side("SwitchAnswer", answer),
    }
