"""The requests about controllers: load, switch, tune, command and give goals."""

import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

from pydantic import JsonValue

from station import wire
from station.client.connection import ClientPart, Sleep, segment
from station.client.errors import MotionError
from station.client.poses import Pose
from station.wire.controllers import SWITCH_BOUND, SwitchStrictness
from station.wire.excitations import BenchRequest, BenchResponse, Excitation
from station.wire.protocol import KEY_HEADER

Strictness = SwitchStrictness
REHEARSAL_BOUND = 60.0
"""Extra time for the answer to a rehearsal [s]."""
POLL = 0.05
"""Time between two requests for the state of a goal [s]."""
_FINAL = {"succeeded", "aborted", "preempted"}


class AsyncGoalHandle:
    """A goal of a controller: `station.start_goal(…)`, `station.start_move(…)`.

    Args:
        client: The client that has sent the goal.
        controller: The controller that has the goal.
        latest: The answer to the goal's request.
        sleep: Function that waits for a time [s].

    Attributes:
        controller: The controller that has the goal.
        latest: State of the goal when it was last read.
    """

    def __init__(
        self,
        client: "AsyncControllersClient",
        controller: str,
        latest: wire.Goal,
        sleep: Sleep,
    ) -> None:
        self._client = client
        self._sleep = sleep
        self.controller = controller
        self.latest = latest

    @property
    def is_final(self) -> bool:
        """True if the goal had ended when it was last read."""
        return self.latest.status in _FINAL

    async def refresh(self) -> wire.Goal:
        """Return the goal with its present progress."""
        self.latest = await self._client.goal(self.controller, self.latest.id)
        return self.latest

    async def cancel(self) -> None:
        """Cancel the goal; the joints hold from the next cycle on."""
        await self._client.cancel_goal(self.controller, self.latest.id)

    async def ended(self, timeout: float | None = None) -> wire.Goal:
        """Wait until the goal has ended, in whatever way, and return it.

        Args:
            timeout: Longest wait [s]; None waits for ever. The goal goes on after the
                wait.

        Raises:
            MotionError: The goal did not end in time.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self.is_final:
            if deadline is not None and time.monotonic() > deadline:
                raise MotionError(
                    f"The goal of '{self.controller}' did not end within {timeout} s.",
                    "Wait longer, or cancel the goal.",
                )
            await self._sleep(POLL)
            await self.refresh()
        return self.latest

    async def wait(self, timeout: float | None = None) -> wire.Goal:
        """Wait until the goal has succeeded and return it.

        Args:
            timeout: Longest wait [s]; None waits for ever. The goal goes on after the
                wait.

        Raises:
            MotionError: The goal was aborted or preempted, or did not end in time.
        """
        goal = await self.ended(timeout)
        if goal.status != "succeeded":
            why = goal.result.message if goal.result else ""
            raise MotionError(
                f"The goal of '{self.controller}' was {goal.status}. {why}".rstrip(),
                "See GET /status for a stop and /robots for errors of the arm.",
            )
        return goal


class AsyncControllersClient(ClientPart):
    """The requests about controllers, which every station client has."""

    _path = "/controllers"

    async def controllers(self) -> list[wire.ControllerState]:
        """Return all loaded controllers."""
        return (await self._get("/controllers", wire.Controllers)).controllers

    async def controller(self, name: str) -> wire.ControllerState:
        """Return one controller."""
        return await self._get(self._of(name), wire.ControllerState)

    async def chains(self) -> wire.ControllerChains:
        """Return the loaded controllers, with the references that each commands."""
        return await self._get("/controllers/chains", wire.ControllerChains)

    async def load_controller(
        self,
        name: str,
        type: str | None = None,  # noqa: A002 - ros_control's word
        params: Mapping[str, JsonValue] | None = None,
        *,
        timeout: float | None = None,
        unknown_params: Literal["refuse", "tell"] | None = None,
        idempotency_key: str | None = None,
    ) -> wire.ControllerState:
        """Load a controller; loading the same one again changes nothing.

        Args:
            name: Its name.
            type: Its plugin type; None takes that of the station's configuration.
            params: Its parameters; None takes those of the station's configuration.
            timeout: How long its import, constructor and init may take [s]; None for
                the station's default.
            unknown_params: Treatment of parameters that its type does not know:
                `refuse`, the default; or `tell`, which lists them in its `notes`, for
                files of ROS.
            idempotency_key: Random name of the request, 1 to 200 visible ASCII
                characters. A request that is repeated with the same key within 10
                minutes, e.g. after a lost connection, is carried out once.
        """
        given = {
            "name": name,
            "type": type,
            "params": params,
            "timeout": timeout,
            "unknown_params": unknown_params,
        }
        request = wire.LoadRequest.model_validate({
            key: value for key, value in given.items() if value is not None
        })
        return await self._send(
            "POST",
            "/controllers",
            wire.ControllerState,
            request,
            headers=_keyed(idempotency_key),
            patience=request.timeout,
        )

    async def unload_controller(
        self, name: str, *, idempotency_key: str | None = None
    ) -> wire.ControllerState:
        """Unload a stopped controller, or cancel its loading; return its last state.

        Args:
            name: Its name.
            idempotency_key: As for `load_controller`.
        """
        path, headers = self._of(name), _keyed(idempotency_key)
        return await self._send("DELETE", path, wire.ControllerState, headers=headers)

    async def switch_controllers(
        self,
        *,
        start: Sequence[str] = (),
        stop: Sequence[str] = (),
        strictness: Strictness = "strict",
        start_asap: bool = False,
        timeout: float = 0.0,
        bound: float | None = SWITCH_BOUND,
        dry_run: bool = False,
        idempotency_key: str | None = None,
    ) -> wire.SwitchResult:
        """Start and stop controllers in one cycle.

        Args:
            start: Names to start.
            stop: Names to stop.
            strictness: `strict` for all or nothing; `best_effort` for the possible
                part; `auto` like `strict`, but also starts and stops the other
                controllers of a chain; `force_auto` like `auto`, but also stops
                controllers that claim a resource of a starting one.
            start_asap: Start each as soon as its joints are ready.
            timeout: How long the hardware may take [s], 0 to 60; 0 means as long as it
                takes, up to `bound`.
            bound: How long a switch without a timeout may take [s of wall time]; None
                means as long as the hardware takes.
            dry_run: Only return the plan.
            idempotency_key: As for `load_controller`.
        """
        request = wire.SwitchRequest(
            start=list(start),
            stop=list(stop),
            strictness=strictness,
            start_asap=start_asap,
            timeout=timeout,
            bound=bound,
            dry_run=dry_run,
        )
        return await self._send(
            "POST",
            "/controllers/switch",
            wire.SwitchResult,
            request,
            headers=_keyed(idempotency_key),
            patience=timeout or (math.inf if bound is None else bound),
        )

    async def gains(self, name: str) -> wire.Gains:
        """Return a controller's gains, their units and ranges, and their ETag."""
        return await self._get(self._of(name, "gains"), wire.Gains)

    async def set_gains(
        self, name: str, values: Mapping[str, float], etag: str | None = None
    ) -> wire.GainsChange:
        """Change gains in one cycle; the others keep their value.

        Args:
            name: The controller.
            values: New values by name, in the units of the schema.
            etag: ETag of gains that were read; the station refuses the change if they
                have changed since.
        """
        path = self._of(name, "gains")
        request = wire.GainsPatch(values=dict(values))
        headers = {} if etag is None else {"If-Match": etag}
        return await self._send(
            "PATCH", path, wire.GainsChange, request, headers=headers
        )

    async def download_config(self, name: str, target: Path | str) -> Path:
        """Write the parameters of a controller, with its gains in force, to a new file.

        Args:
            name: The controller.
            target: The file, YAML as ros_control has it; it must not exist.

        Returns:
            The path of the file.

        Raises:
            FileExistsError: The file already exists.
        """
        target = Path(target)
        await self._connection.download(self._of(name, "config.yaml"), target)
        return target

    async def last_command(self, name: str) -> wire.CommandInfo:
        """Return the elements of a controller's set-point, and the last set-point."""
        return await self._get(self._of(name, "command"), wire.CommandInfo)

    async def command(
        self,
        name: str,
        values: Sequence[float | None],
        epoch: int | None = None,
        timeout: float | None = None,
        rates: Sequence[float] | None = None,
        certificate: str | None = None,
    ) -> wire.CommandAccepted:
        """Send a set-point.

        Args:
            name: The controller.
            values: One number per element, in its order and units; None leaves an
                element at its last command.
            epoch: Refuse when a stop or reset came since that epoch.
            timeout: How long it is valid [s], 0 for ever; None for the controller's own
                timeout.
            rates: How fast the set-point changes [rad/s or m/s], for controllers that
                feed it forward.
            certificate: Certificate of a rehearsal of this command; None without one.
        """
        request = wire.CommandRequest(
            command=list(values),
            epoch=epoch,
            timeout=timeout,
            rates=None if rates is None else list(rates),
        )
        path = _certified(self._of(name, "command"), certificate)
        return await self._send("PUT", path, wire.CommandAccepted, request)

    async def controller_state(self, name: str) -> wire.ControllerSample:
        """Return the values of a controller in the last cycle."""
        return await self._get(self._of(name, "state"), wire.ControllerSample)

    async def bench(
        self,
        name: str,
        excitation: Excitation,
        *,
        duration: float = 2.0,
        settling_band: float = 0.02,
        relay_gain: float | None = None,
        run: str | None = None,
    ) -> BenchResponse:
        """Excite one joint through a running controller, and return its response.

        The answer comes when the joint is back at its initial position. The station
        refuses a motion that is too large, too fast or too near a limit before anything
        moves.

        Args:
            name: A running controller that takes set-points of joints.
            excitation: Motion of the joint, e.g. a
                `station.wire.excitations.Step` with the joint and an amplitude.
            duration: How long the response is measured [s], above 0, at most 10.
            settling_band: Half-width of the band of the settling time, as a share of
                the step, above 0 and below 1.
            relay_gain: Proportional gain of the joint during a relay test, > 0; its
                integral and derivative gain are 0 meanwhile. None leaves the gains in
                force.
            run: Name under which the station keeps the response; None lets the station
                choose.
        """
        request = BenchRequest(
            excitation=excitation,
            duration=duration,
            settling_band=settling_band,
            relay_gain=relay_gain,
            name=run,
        )
        path, patience = self._of(name, "bench"), 5.0 * request.duration
        return await self._send("POST", path, BenchResponse, request, patience=patience)

    async def submit_goal(
        self,
        name: str,
        goal: Mapping[str, JsonValue],
        epoch: int | None = None,
        certificate: str | None = None,
    ) -> wire.Goal:
        """Give a running controller a goal, which replaces the goal before.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
            certificate: Certificate of a rehearsal of this command; None without one.
        """
        path = _certified(self._of(name, "goals"), certificate)
        request = wire.GoalRequest(goal=dict(goal), epoch=epoch)
        return await self._send("POST", path, wire.Goal, request)

    async def goals(self, name: str) -> list[wire.Goal]:
        """Return a controller's latest goals, oldest first."""
        return (await self._get(self._of(name, "goals"), wire.Goals)).goals

    async def goal(self, name: str, goal_id: str) -> wire.Goal:
        """Return a goal, with its progress, or how and why it ended."""
        return await self._get(self._of(name, f"goals/{segment(goal_id)}"), wire.Goal)

    async def cancel_goal(self, name: str, goal_id: str) -> wire.Goal:
        """Cancel a goal; the joints hold from the next cycle on."""
        path = self._of(name, f"goals/{segment(goal_id)}")
        return await self._send("DELETE", path, wire.Goal)

    async def follow_trajectory(
        self,
        name: str,
        trajectory: Mapping[str, JsonValue],
        epoch: int | None = None,
        certificate: str | None = None,
    ) -> wire.CommandAccepted:
        """Let a running controller follow a trajectory without a goal.

        Args:
            name: The controller.
            trajectory: A JointTrajectory message, times in seconds; without points the
                joints stop and hold.
            epoch: Refuse when a stop or reset came since that epoch.
            certificate: Certificate of a rehearsal of this command; None without one.
        """
        request = wire.TrajectoryRequest(trajectory=dict(trajectory), epoch=epoch)
        path = _certified(self._of(name, "trajectory"), certificate)
        return await self._send("POST", path, wire.CommandAccepted, request)

    async def query_state(
        self, name: str, time: float | None = None
    ) -> wire.DesiredState:
        """Return the desired joint state of a trajectory controller.

        Args:
            name: The controller.
            time: Station time [s]; None for the present time.
        """
        query = None if time is None else {"time": repr(time)}
        return await self._get(self._of(name, "query_state"), wire.DesiredState, query)

    async def start_goal(
        self,
        name: str,
        goal: Mapping[str, JsonValue],
        epoch: int | None = None,
        certificate: str | None = None,
    ) -> AsyncGoalHandle:
        """Give a controller a goal, and return a handle to wait for it or cancel it.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
            certificate: Certificate of a rehearsal of this command; None without one.
        """
        answer = await self.submit_goal(name, goal, epoch, certificate)
        return AsyncGoalHandle(self, name, answer, self._connection.sleep)

    async def start_motion_sequence(
        self,
        name: str,
        motions: Sequence[Mapping[str, JsonValue]],
        epoch: int | None = None,
        certificate: str | None = None,
    ) -> AsyncGoalHandle:
        """Let a trajectory controller follow PTP, LIN and CIRC motions.

        Args:
            name: The controller.
            motions: Messages in the form of control_msgs/MotionPrimitive.
            epoch: Refuse when a stop or reset came since that epoch.
            certificate: Certificate of a rehearsal of this goal; None without one.
        """
        goal: dict[str, JsonValue] = {"motions": [dict(one) for one in motions]}
        return await self.start_goal(name, {"trajectory": goal}, epoch, certificate)

    async def rehearse(
        self,
        steps: Sequence[Mapping[str, JsonValue]],
        *,
        seconds: float | None = None,
        certificate: bool = False,
    ) -> wire.Rehearsal:
        """Try commands in a copy of the station; nothing moves.

        Args:
            steps: The commands: mappings with `kind` (`set_point`, `goal`,
                `trajectory`, `switch`, `gains`, `path`), the fields of that kind, and
                `at`, its time [s since the beginning].
            seconds: How long the rehearsal lasts [s]; None ends it when all goals have
                ended and the joints stand still, after 30 s at the latest.
            certificate: Whether to ask for a certificate, with which the commands are
                carried out as rehearsed.
        """
        request: dict[str, JsonValue] = {
            "steps": [dict(step) for step in steps],
            "seconds": seconds,
            "certificate": certificate,
        }
        return await self._send(
            "POST", "/rehearse", wire.Rehearsal, request, patience=REHEARSAL_BOUND
        )

    async def plan(
        self,
        controller: str,
        target: Mapping[str, float] | Pose | str,
        *,
        timeout: float = 2.0,
        seed: int = 0,
    ) -> wire.Plan:
        """Return a plan without collisions to a target; nothing moves.

        Args:
            controller: A running trajectory controller.
            target: Target positions [rad or m] by joint, where other joints stay; a
                `Pose` of a Franka's end effector; or the name of a pose of the robot.
            timeout: How long to search [s], above 0 and at most 30.
            seed: Seed of the random numbers; another seed finds another path.
        """
        request: dict[str, JsonValue] = {
            "controller": controller,
            **_target(target),
            "timeout": timeout,
            "seed": seed,
        }
        return await self._send(
            "POST", "/plan", wire.Plan, request, patience=REHEARSAL_BOUND + timeout
        )

    async def controller_types(self) -> list[wire.ControllerType]:
        """Return the types of controllers that can be loaded."""
        path = "/controller-types"
        return (await self._get(path, wire.ControllerTypes)).controller_types

    async def reload_controller_types(self, *, force_kill: bool = False) -> list[str]:
        """Let the next load of each type import its Python module again.

        Args:
            force_kill: Whether to stop and unload all controllers first.

        Returns:
            Names of the controllers that were unloaded.
        """
        path = "/controller-types/reload"
        request = wire.ReloadRequest(force_kill=force_kill)
        answer = await self._send(
            "POST", path, wire.Reloaded, request, patience=SWITCH_BOUND
        )
        return answer.unloaded


def _target(target: Mapping[str, float] | Pose | str) -> dict[str, JsonValue]:
    """Return the target of a plan in the form of its request."""
    if isinstance(target, str):
        return {"name": target}
    if isinstance(target, Pose):
        place: dict[str, JsonValue] = {"position": [*target.position]}
        if target.orientation is not None:
            place["orientation"] = [*target.orientation]
        return {"pose": place}
    return {"positions": dict(target)}


def _certified(path: str, certificate: str | None) -> str:
    """Return the path of a command with the certificate of its rehearsal."""
    return path if certificate is None else f"{path}?certificate={segment(certificate)}"


def _keyed(key: str | None) -> dict[str, str]:
    """Return the header with the key of a request; empty without a key."""
    return {} if key is None else {KEY_HEADER: key}
