"""The channels of a recording, live, for Foxglove and whoever speaks its protocol.

foxglove-sdk serves them from threads of its own. Messages are made only for channels
that a client has subscribed to. Parameters are the gains, `controller/gain`; the
service `/switch_controllers` starts and stops controllers.
"""

import json
import threading
import time
from collections.abc import Callable

import foxglove
from foxglove import (
    MessageSchema,
    Parameter,
    ParameterType,
    Service,
    ServiceRequest,
    ServiceSchema,
)
from foxglove.websocket import Capability, Client, ServerListener
from typing_extensions import override

from station.core.control.switching import SwitchRequest
from station.core.description.urdf import Urdf
from station.core.errors import InvalidCommandError, StationError
from station.core.facade.station import Station
from station.records import messages
from station.records.cycle_messages import CycleMessages, Message
from station.records.cycle_row import RowPacker
from station.records.frames import transforms

RATE = 50.0
"""Cycles per second that are sent [Hz wall time]."""
_SLASH = "/"
_SWITCH_REQUEST = json.dumps({
    "type": "object",
    "properties": {
        name: {"type": "array", "items": {"type": "string"}}
        for name in ("start", "stop")
    },
}).encode()
_SWITCH_ANSWER = json.dumps({
    "type": "object",
    "properties": {"ok": {"type": "boolean"}, "message": {"type": "string"}},
}).encode()


class FoxgloveServer(ServerListener):
    """Serves one station until `close`.

    Whoever reaches the port may read, change gains and switch controllers: there are
    no tokens in this protocol. So it listens at the loopback address unless told.

    Args:
        station: The station.
        host: Address to listen at.
        port: TCP port; 0 for any free one.
        urdf: The robot for transforms; None sends none.
        texts: Text by topic that each client gets, such as `/robot_description`.
        warn: Takes a line about what a client asked for in vain.

    Raises:
        RuntimeError: Nobody can listen there.
    """

    def __init__(
        self,
        station: Station,
        *,
        host: str,
        port: int,
        urdf: Urdf | None = None,
        texts: dict[str, str] | None = None,
        warn: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._station = station
        self._urdf = urdf
        self._texts = dict(texts or {})
        self._warn = warn
        loop = station.loop
        self._encoder = CycleMessages(time.time_ns() - round(loop.time * 1e9))
        self._packer = RowPacker(station.joint_names, self._elements)
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        self._cycle = 0
        self._described = 0.0
        self._end = threading.Event()
        self._server = foxglove.start_server(
            name="control station",
            host=host,
            port=port,
            capabilities=[Capability.Parameters, Capability.Services],
            supported_encodings=["json"],
            server_listener=self,
            services=[self._switch_service()],
            context=self._context,
        )
        self._thread = threading.Thread(target=self._run, name="foxglove", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The TCP port."""
        return self._server.port

    def close(self) -> None:
        """End the thread and the connections."""
        self._end.set()
        self._thread.join(1.0)
        self._server.stop()

    def send(self) -> None:
        """Send the newest cycle to those who want it."""
        records, _ = self._station.snapshots.records_since(self._cycle)
        if not records:
            return
        row = self._packer.unpack(self._packer.pack(records[-1]))
        self._cycle = row.cycle
        for message in self._encoder.of_row(row):
            self._log(message, row.time)
        if self._urdf is not None:
            self._send_transforms(self._urdf, row.time)
        now = time.monotonic()
        if now - self._described > 1.0:
            # Whoever subscribes later needs them, too.
            self._described = now
            for topic, text in self._texts.items():
                self._log(self._encoder.of_text(topic, text), row.time)

    @override
    def on_get_parameters(
        self, client: Client, param_names: list[str], request_id: str | None = None
    ) -> list[Parameter]:
        """Return gains as parameters, all when `param_names` is empty."""
        return self._parameters(param_names)

    @override
    def on_set_parameters(
        self, client: Client, parameters: list[Parameter], request_id: str | None = None
    ) -> list[Parameter]:
        """Set gains, all or none, between two cycles; return those in force."""
        wanted: dict[str, dict[str, float]] = {}
        for one in parameters:
            controller, _, gain = one.name.partition(_SLASH)
            value = one.get_value()
            if isinstance(value, int | float):
                wanted.setdefault(controller, {})[gain] = float(value)
        try:
            self._station.tuning.set_many(wanted)
        except StationError as error:
            self._warn(f"A Foxglove client could not set gains: {error}")
        return self._parameters([one.name for one in parameters])

    def _parameters(self, names: list[str]) -> list[Parameter]:
        return [
            Parameter(name, value=value, type=ParameterType.Float64)
            for name, value in self._gains().items()
            if not names or name in names
        ]

    def _run(self) -> None:
        while not self._end.wait(1.0 / RATE):
            self.send()

    def _log(self, message: Message, stamp: float) -> None:
        channel = self._channels.get(message.topic)
        if channel is None:
            kind = message.kind
            schema = foxglove.Schema(
                name=kind.name, encoding="ros2msg", data=kind.text.encode()
            )
            channel = foxglove.Channel(
                message.topic,
                message_encoding="cdr",
                schema=schema,
                context=self._context,
            )
            self._channels[message.topic] = channel
        if channel.has_sinks():
            channel.log(message.data, log_time=self._encoder.stamp(stamp))

    def _send_transforms(self, urdf: Urdf, stamp: float) -> None:
        channel = self._channels.get("/tf")
        if channel is not None and not channel.has_sinks():
            return
        latest = self._station.latest()
        positions = dict(zip(self._station.joint_names, latest.position, strict=True))
        wall = self._encoder.stamp(stamp) / 1e9
        data = messages.TF_MESSAGE.encode(transforms(urdf, positions, wall))
        self._log(Message("/tf", messages.TF_MESSAGE, data), stamp)

    def _gains(self) -> dict[str, float]:
        return {
            f"{controller}{_SLASH}{name}": value
            for controller, values in self._station.tuning.all_gains().items()
            for name, value in values.items()
        }

    def _switch_service(self) -> Service:
        def side(name: str, data: bytes) -> MessageSchema:
            schema = foxglove.Schema(name=name, encoding="jsonschema", data=data)
            return MessageSchema(encoding="json", schema=schema)

        return Service(
            "/switch_controllers",
            schema=ServiceSchema(
                "control_station/SwitchControllers",
                request=side("SwitchRequest", _SWITCH_REQUEST),
                response=side("SwitchAnswer", _SWITCH_ANSWER),
            ),
            handler=self._switch,
        )

    def _switch(self, request: ServiceRequest) -> bytes:
        try:
            asked = json.loads(request.payload)
            start, stop = _names(asked, "start"), _names(asked, "stop")
            result = self._station.switch_controllers(SwitchRequest(start, stop))
        except (StationError, ValueError) as error:
            return json.dumps({"ok": False, "message": str(error)}).encode()
        return json.dumps({"ok": result.ok, "message": ""}).encode()

    def _elements(self, name: str) -> list[str]:
        try:
            return list(self._station.manager.get_controller(name).joint_names)
        except StationError:
            return []  # unloaded since; its elements are numbered


def _names(asked: object, key: str) -> list[str]:
    """Return a list of names of a request.

    Raises:
        InvalidCommandError: It is none.
    """
    names = asked.get(key, []) if isinstance(asked, dict) else None
    if isinstance(names, list) and all(isinstance(one, str) for one in names):
        return names
    raise InvalidCommandError(
        f"'{key}' is no list of names of controllers.",
        remedy='Send {"start": ["arm"], "stop": []}.',
    )
