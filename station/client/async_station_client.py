"""The client for asyncio: one method per route."""

from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Self

import httpx
from pydantic import JsonValue

from station.client import calls, robot_calls
from station.client.async_robot_client import AsyncRobotClient
from station.client.async_simulation_client import AsyncSimulationClient
from station.client.async_stream import AsyncStream
from station.client.calls import Call, ModelT, Strictness
from station.client.errors import StationUnreachableError
from station.client.robot_calls import Restart
from station.client.stream_options import Rate, StreamOptions, bearer
from station.wire import (
    ArmReport,
    CommandAccepted,
    CommandInfo,
    ControllerSample,
    ControllerState,
    ControllerType,
    DesiredState,
    Gains,
    GainsChange,
    Goal,
    Hardware,
    Health,
    JointStates,
    LoopReport,
    Ready,
    Recoveries,
    SceneObject,
    Session,
    Status,
    StopState,
    StreamTicket,
    SwitchRequest,
    SwitchResult,
)


class AsyncStationClient:
    """Talks to a station from asyncio code.

    Every method raises `ApiError` when the station refuses, and its child
    `StationUnreachableError` when it does not answer. Arguments that cannot be sent
    at all (NaN, a string for a number) raise pydantic's `ValidationError`, a
    `ValueError`, before anything is sent.

    Proxies and other settings of the environment are not used: a station is near.

    Args:
        url: The station, e.g. `http://127.0.0.1:8000`.
        token: Operator or viewer token; without one only `health` and `ready` work.
        timeout: Longest wait for an answer [s].
        transport: How requests travel; for tests.

    Attributes:
        simulation: Pause, step and reset of a simulated robot.
    """

    def __init__(
        self,
        url: str = "http://127.0.0.1:8000",
        token: str | None = None,
        *,
        timeout: float = 10.0,
        transport: httpx.AsyncBaseTransport | None = None,
    ) -> None:
        self.url = url.rstrip("/")
        self.timeout = timeout
        self._token = token
        self.simulation = AsyncSimulationClient(self._do)
        self._http = httpx.AsyncClient(
            base_url=self.url,
            headers=bearer(token),
            timeout=timeout,
            transport=transport,
            trust_env=False,
        )

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    def move_to(self, url: str, token: str | None) -> None:
        """Talk to another station from the next request on.

        A stream that was opened before goes on with the station it was opened at.

        Args:
            url: The station.
            token: Operator or viewer token.
        """
        self.url = url.rstrip("/")
        self._token = token
        self._http.base_url = httpx.URL(self.url)
        self._http.headers.update(bearer(token))

    async def _do(self, call: Call[ModelT]) -> ModelT:
        try:
            answer = await self._http.request(
                call.method,
                call.path,
                content=call.body,
                headers=call.sent_headers(),
                timeout=self.timeout + call.patience,
            )
        except httpx.TransportError as error:
            raise StationUnreachableError(self.url, error) from error
        return call.read_answer(answer.status_code, answer.content)

    async def health(self) -> Health:
        """Return that the process lives, and its boot_id."""
        return await self._do(calls.health())

    async def ready(self) -> Ready:
        """Return when the loop runs with fresh cycles; an error says why not."""
        return await self._do(calls.ready())

    async def session(self) -> Session:
        """Return which role the token has."""
        return await self._do(calls.session())

    async def status(self) -> Status:
        """Return the station at a glance."""
        return await self._do(calls.status())

    async def hardware(self) -> Hardware:
        """Return interfaces, claims, limits, transmissions and clamps of the robot."""
        return await self._do(calls.hardware())

    async def controllers(self) -> list[ControllerState]:
        """Return all loaded controllers."""
        return (await self._do(calls.controllers())).controllers

    async def controller(self, name: str) -> ControllerState:
        """Return one controller."""
        return await self._do(calls.controller(name))

    async def load_controller(
        self,
        name: str,
        type: str | None = None,  # noqa: A002 - ros_control's word
        params: Mapping[str, JsonValue] | None = None,
    ) -> ControllerState:
        """Load a controller; loading the same one again changes nothing.

        Args:
            name: Its name.
            type: Its plugin type; None when the station's configuration has it.
            params: Its parameters; None when the station's configuration has them.
        """
        return await self._do(calls.load_controller(name, type, params))

    async def unload_controller(self, name: str) -> ControllerState:
        """Unload a stopped controller and return what it was."""
        return await self._do(calls.unload_controller(name))

    async def switch_controllers(
        self,
        *,
        start: Sequence[str] = (),
        stop: Sequence[str] = (),
        strictness: Strictness = "strict",
        start_asap: bool = False,
        timeout: float = 0.0,
        dry_run: bool = False,
    ) -> SwitchResult:
        """Start and stop controllers in one cycle.

        Args:
            start: Names to start.
            stop: Names to stop.
            strictness: `strict` for all or nothing, `best_effort` for what is possible.
            start_asap: Start each as soon as its joints are ready.
            timeout: Deadline [s], 0 to 60; 0 means the station's default.
            dry_run: Only say what would happen.
        """
        request = SwitchRequest(
            start=list(start),
            stop=list(stop),
            strictness=strictness,
            start_asap=start_asap,
            timeout=timeout,
            dry_run=dry_run,
        )
        return await self._do(calls.switch_controllers(request))

    async def gains(self, name: str) -> Gains:
        """Return a controller's gains, what they may be, and their ETag."""
        return await self._do(calls.gains(name))

    async def set_gains(
        self, name: str, values: Mapping[str, float], etag: str | None = None
    ) -> GainsChange:
        """Change gains in one cycle; the others keep their value.

        Args:
            name: The controller.
            values: New values by name, in the units of the schema.
            etag: Refuse when the gains are no longer those of that ETag.
        """
        return await self._do(calls.set_gains(name, values, etag))

    async def last_command(self, name: str) -> CommandInfo:
        """Return what set-points a controller takes, and the last it took."""
        return await self._do(calls.last_command(name))

    async def command(
        self,
        name: str,
        values: Sequence[float],
        epoch: int | None = None,
        timeout: float | None = None,
        rates: Sequence[float] | None = None,
    ) -> CommandAccepted:
        """Send a set-point.

        Args:
            name: The controller.
            values: One number per element, in its order and units.
            epoch: Refuse when a stop or reset came since that epoch.
            timeout: How long it is valid [s], 0 for ever; None: the controller's own.
            rates: How fast it changes, for controllers that feed it forward.
        """
        return await self._do(calls.command(name, values, epoch, timeout, rates))

    async def controller_state(self, name: str) -> ControllerSample:
        """Return what a controller did in the last cycle."""
        return await self._do(calls.controller_state(name))

    async def submit_goal(
        self, name: str, goal: Mapping[str, JsonValue], epoch: int | None = None
    ) -> Goal:
        """Give a running controller a goal; it replaces the one before.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        return await self._do(calls.submit_goal(name, goal, epoch))

    async def goals(self, name: str) -> list[Goal]:
        """Return a controller's latest goals, oldest first."""
        return (await self._do(calls.goals(name))).goals

    async def goal(self, name: str, goal_id: str) -> Goal:
        """Return how far a goal is, or how and why it ended."""
        return await self._do(calls.goal(name, goal_id))

    async def cancel_goal(self, name: str, goal_id: str) -> Goal:
        """Ask for the end of a goal; the joints hold from the next cycle on."""
        return await self._do(calls.cancel_goal(name, goal_id))

    async def follow_trajectory(
        self,
        name: str,
        trajectory: Mapping[str, JsonValue],
        epoch: int | None = None,
    ) -> CommandAccepted:
        """Let a running controller follow a trajectory without a goal.

        Args:
            name: The controller.
            trajectory: A JointTrajectory message, times in seconds; without points the
                joints stop and hold.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        return await self._do(calls.follow_trajectory(name, trajectory, epoch))

    async def query_state(self, name: str, time: float | None = None) -> DesiredState:
        """Return where the joints of a trajectory controller shall be.

        Args:
            name: The controller.
            time: Station time [s]; now when None.
        """
        return await self._do(calls.query_state(name, time))

    async def joint_states(self) -> JointStates:
        """Return the joints of the last cycle."""
        return await self._do(calls.joint_states())

    async def controller_types(self) -> list[ControllerType]:
        """Return the plugins that can be loaded."""
        return (await self._do(calls.controller_types())).controller_types

    async def robots(self) -> list[ArmReport]:
        """Return all arms, their modes and errors, and what to do."""
        return (await self._do(robot_calls.robots())).robots

    async def recover_all(self, restart: Restart = "none") -> Recoveries:
        """Clear the errors of all arms; with `previous` start controllers again."""
        return await self._do(robot_calls.recover_all(restart))

    def robot(self, arm_id: str) -> AsyncRobotClient:
        """Return the client of one arm."""
        return AsyncRobotClient(self._do, arm_id)

    async def scene(self) -> list[SceneObject]:
        """Return the things around a simulated robot, where they are now."""
        return (await self._do(calls.scene())).objects

    async def loop(self) -> LoopReport:
        """Return how the control loop does."""
        return await self._do(calls.loop())

    async def reset_loop_statistics(self) -> LoopReport:
        """Start the loop's statistics afresh."""
        return await self._do(calls.reset_loop_statistics())

    async def stop_state(self) -> StopState:
        """Return the state of the latched stop."""
        return await self._do(calls.stop_state())

    async def stop(self, reason: str = "") -> StopState:
        """Stop the robot; it stays stopped until released.

        Args:
            reason: For the record.
        """
        return await self._do(calls.stop(reason))

    async def release_stop(self, *, arm: bool = False) -> StopState:
        """Take back a stop, in two steps; nothing resumes by itself.

        Args:
            arm: False: the cause is gone. True, afterwards: motion is allowed again.
        """
        return await self._do(calls.release_stop(arm=arm))

    async def stream_ticket(self) -> StreamTicket:
        """Return a ticket that opens one WebSocket, e.g. for a browser."""
        return await self._do(calls.stream_ticket())

    def stream(
        self,
        topic: str,
        *,
        rate: Rate | None = None,
        fields: Sequence[str] = (),
        reconnect: bool = True,
    ) -> AsyncStream:
        """Return a stream of a topic; `async for` over it.

        Args:
            topic: `joint_states`, `controllers`, `loop`, `controller_state/<name>`,
                `robot_state/<arm_id>`.
            rate: Frames per second [Hz], or "full" for every cycle, in batches.
            fields: Only these keys of `data`; all when empty.
            reconnect: Connect again when the link breaks, for ever.
        """
        return AsyncStream(
            StreamOptions(self.url, self._token, topic, rate, tuple(fields), reconnect)
        )
