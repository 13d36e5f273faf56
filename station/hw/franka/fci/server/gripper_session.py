"""One client of a hand: its requests and the answers at their ends; no sockets.

A newer command takes the fingers over; the older one is answered with ABORTED.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from station.core.errors import GripperCommandError, InvalidCommandError
from station.core.franka import GraspRequest
from station.core.ports.goal import GoalStatus
from station.hw.franka.fci.server.message_reader import (
    MessageReader,
    Request,
)
from station.hw.franka.fci.wire.gripper_protocol import (
    GRIPPER_HEADER,
    HAND,
    GripperCommand,
    GripperProtocol,
    GripperStatus,
)
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import ConnectStatus
from station.hw.franka.hand.hand_services import HandServices

_ENDS = {
    GoalStatus.SUCCEEDED: GripperStatus.SUCCESS,
    GoalStatus.ABORTED: GripperStatus.UNSUCCESSFUL,
}
_NOTHING: Mapping[str, Any] = MappingProxyType({})


class GripperSession:
    """Serves one client; a new one for the next client. Control thread.

    Args:
        hand: The hand; whoever owns the session advances it once per cycle.
        protocol: The version that is spoken.

    Attributes:
        udp_port: The client's UDP port; None until it has connected.
    """

    def __init__(self, hand: HandServices, protocol: GripperProtocol = HAND) -> None:
        self._hand = hand
        self._protocol = protocol
        self._reader = MessageReader(GRIPPER_HEADER, protocol.exchanges)
        self._running: Request[GripperCommand] | None = None
        self.udp_port: int | None = None

    def receive(self, data: bytes) -> bytes:
        """Take bytes of the TCP stream; return the answers that are due at once.

        Args:
            data: The next bytes.

        Raises:
            FciProtocolError: The connection must end.
        """
        return b"".join(self._answer(request) for request in self._reader.feed(data))

    def after_cycle(self) -> bytes:
        """Return the answer that the end of a motion of the fingers makes due."""
        if self._running is None:
            return b""
        state = self._hand.get_state()
        if state.command is not None or state.last is None:
            return b""
        status = _ENDS.get(state.last.status, GripperStatus.ABORTED)
        return self._end(status)

    def state(self, message_id: int) -> bytes:
        """Return the state of the hand as a message.

        Args:
            message_id: Its number.
        """
        state = self._hand.get_state()
        return self._protocol.state.pack({
            "message_id": message_id % 2**32,
            "width": state.width,
            "max_width": state.max_width,
            "is_grasped": state.is_grasped,
            "temperature": round(state.temperature),
        })

    def close(self) -> None:
        """Stop the fingers if a motion of this client runs: it has gone."""
        if self._running is not None:
            self._running = None
            self._hand.stop()

    def _answer(self, request: Request[GripperCommand]) -> bytes:
        if request.command is GripperCommand.CONNECT:
            return self._connect(request)
        if self.udp_port is None:
            raise FciProtocolError(
                f"The client sent {request.command.name} before it had connected.",
                remedy="Connect first, with a version that the hand speaks.",
            )
        try:
            self._begin(request)
        except (GripperCommandError, InvalidCommandError):
            return self._reader.answer(request, GripperStatus.FAIL, _NOTHING)
        answers = self._end(GripperStatus.ABORTED)
        if request.command is GripperCommand.STOP:
            done = self._reader.answer(request, GripperStatus.SUCCESS, _NOTHING)
            return answers + done
        self._running = request
        return answers

    def _connect(self, request: Request[GripperCommand]) -> bytes:
        own = self._protocol.version
        status = ConnectStatus.INCOMPATIBLE_LIBRARY_VERSION
        if request.values["version"] == own:
            self.udp_port = request.values["udp_port"]
            status = ConnectStatus.SUCCESS
        return self._reader.answer(request, status, {"version": own})

    def _begin(self, request: Request[GripperCommand]) -> None:
        hand, values = self._hand, request.values
        match request.command:
            case GripperCommand.HOMING:
                hand.homing()
            case GripperCommand.MOVE:
                hand.move(values["width"], values["speed"])
            case GripperCommand.GRASP:
                hand.grasp(
                    GraspRequest(
                        width=values["width"],
                        force=values["force"],
                        speed=values["speed"],
                        epsilon_inner=values["epsilon_inner"],
                        epsilon_outer=values["epsilon_outer"],
                    )
                )
            case _:
                hand.stop()

    def _end(self, status: GripperStatus) -> bytes:
        request, self._running = self._running, None
        if request is None:
            return b""
        return self._reader.answer(request, status, _NOTHING)
