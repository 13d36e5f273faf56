"""Keep up with a station: streams and polls it, and says how old the data is.

Everything here runs on one event loop. A request that fails is repeated until it
succeeds; meanwhile the age of the data grows, and the panels show the data as old.
"""

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Sequence

from pydantic import ValidationError

from station.client import ApiError, AsyncStationClient
from station.ui.link.arm_facts import ARM_FIELDS, ArmFacts, arm_facts
from station.ui.link.station_view import StationView, moves_hand
from station.wire import (
    CommandElement,
    Contact,
    ControllerSample,
    ControllerState,
    ControllerType,
    Hardware,
    JointStates,
    MovingBase,
    Scene,
    SceneObject,
    Status,
    StreamFrame,
)

JOINT_RATE = 50.0
"""Joint states per second, each of which is drawn at once in the 3D view [Hz]."""
BASE_RATE = 30.0
"""Poses of a floating or planar base per second for the 3D view [Hz]."""
ARM_RATE = 10.0
"""States of a Franka arm per second for its frames and forces [Hz]."""
SAMPLE_RATE = 30.0
"""Controller samples per second [Hz]."""
_STATUS_PERIOD = 0.5
_CONTROLLERS_PERIOD = 0.4
_SCENE_PERIOD = 0.1
_RETRY = 0.5


class StationLink:
    """What the dashboard knows of the station, kept up to date by `run`.

    Args:
        client: The station; owned by the caller.
        now: Monotonic clock [s].
        sliding: The joints whose positions are lengths.

    Attributes:
        client: As given.
        now: As given.
        wants_contacts: Whether somebody looks at `contacts`.
    """

    def __init__(
        self,
        client: AsyncStationClient,
        now: Callable[[], float] = time.monotonic,
        sliding: Collection[str] = (),
    ) -> None:
        self.client = client
        self._sliding = frozenset(sliding)
        self.now = now
        self._heard_at: float | None = None
        self._failure = ""
        self._status: Status | None = None
        self._controllers: tuple[ControllerState, ...] = ()
        self._types: tuple[ControllerType, ...] = ()
        self._positions: dict[str, float] = {}
        self._base: MovingBase | None = None
        self._objects: tuple[SceneObject, ...] = ()
        self._scene_of = ""
        self._contacts: tuple[Contact, ...] = ()
        self.wants_contacts = False
        self._elements: dict[str, tuple[CommandElement, ...]] = {}
        self._samples: dict[str, ControllerSample] = {}
        self._messages: dict[str, str] = {}
        self._limits: dict[str, tuple[float, float]] = {}
        self._limits_of = ""  # the boot_id of the station that they come from
        self._followers: dict[str, asyncio.Task[None]] = {}
        self._arm_followers: dict[str, asyncio.Task[None]] = {}
        self._arms: dict[str, ArmFacts] = {}
        self._base_follower: asyncio.Task[None] | None = None
        self._moved = asyncio.Event()
        self._woken = asyncio.Event()
        self._wakes = 0

    @property
    def positions(self) -> dict[str, float]:
        """The newest joint positions by name [rad] or [m]; not to be changed."""
        return self._positions

    @property
    def base(self) -> MovingBase | None:
        """Where a floating or driving base is; None without one."""
        return self._base

    @property
    def objects(self) -> tuple[SceneObject, ...]:
        """The objects around a simulated robot with their last known poses."""
        return self._objects

    @property
    def arms(self) -> dict[str, ArmFacts]:
        """What the Franka arms say of their tools, by arm_id; not to be changed."""
        return self._arms

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Where bodies of a simulated world touch; empty while nobody wants to know."""
        return self._contacts

    async def wait_for_motion(self, most: float) -> None:
        """Wait for the next positions of the joints or of a base; one task may wait.

        Args:
            most: Longest wait [s].
        """
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(most):
                await self._moved.wait()
        self._moved.clear()

    def view(self) -> StationView:
        """Return a frozen view of the newest data."""
        return StationView(
            now=self.now(),
            heard_at=self._heard_at,
            failure=self._failure,
            status=self._status,
            controllers=self._controllers,
            types=self._types,
            positions=dict(self._positions),
            elements=dict(self._elements),
            samples=dict(self._samples),
            messages=dict(self._messages),
            sliding=self._sliding,
            limits=dict(self._limits),
        )

    async def run(self) -> None:
        """Keep up until cancelled."""
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._follow_joints())
                tasks.create_task(self._repeat(self.refresh_status, _STATUS_PERIOD))
                tasks.create_task(self._repeat(self.refresh_scene, _SCENE_PERIOD))
                tasks.create_task(self._repeat(self.refresh_contacts, _SCENE_PERIOD))
                tasks.create_task(
                    self._repeat(self.refresh_controllers, _CONTROLLERS_PERIOD)
                )
        finally:
            followers = [*self._followers.values(), *self._arm_followers.values()]
            if self._base_follower is not None:
                self._base_follower.cancel()
                followers.append(self._base_follower)
            self.watch(())
            self._follow_arms(())
            await asyncio.gather(*followers, return_exceptions=True)

    def wake(self) -> None:
        """Ask the station at once for what would be asked for a moment later."""
        self._wakes += 1
        self._woken.set()
        self._woken.clear()

    async def _pause(self, seconds: float, wakes: int) -> None:
        """Wait, at most until `wake` is called.

        Args:
            seconds: Longest wait [s].
            wakes: `_wakes` before the request that this pause follows. A request that
                was on its way when `wake` was called went to the former station.
        """
        if wakes != self._wakes:
            return
        # Not `wait_for`: before Python 3.12 it may swallow a cancellation.
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._woken.wait()

    def watch(self, names: Collection[str]) -> None:
        """Follow the samples of exactly these controllers."""
        for name in [name for name in self._followers if name not in names]:
            self._followers.pop(name).cancel()
            self._samples.pop(name, None)
        for name in names:
            task = self._followers.get(name)
            if task is None or task.done():
                self._followers[name] = asyncio.create_task(self._follow_sample(name))

    def _follow_arms(self, names: Collection[str]) -> None:
        """Follow exactly these Franka arms."""
        for name in [name for name in self._arm_followers if name not in names]:
            self._arm_followers.pop(name).cancel()
            self._arms.pop(name, None)
        for name in names:
            if name not in self._arm_followers:
                task = asyncio.create_task(self._follow_arm(name))
                self._arm_followers[name] = task

    async def refresh_status(self) -> None:
        """Request the status; after a restart of the station, request everything."""
        status = await self.client.status()
        restarted = self._status is not None and status.boot_id != self._status.boot_id
        if restarted or not self._types:
            self._elements.clear()
            self._types = tuple(await self.client.controller_types())
        self._status = status
        self._heard()
        self._follow_arms([arm.arm_id for arm in status.robots])
        if self._limits_of != status.boot_id:
            self._limits = _position_limits(await self.client.hardware())
            self._limits_of = status.boot_id

    async def refresh_scene(self) -> None:
        """Request the objects of the scene; only once if none of them can move."""
        boot_id = "" if self._status is None else self._status.boot_id
        if self._scene_of == boot_id and not any(o.mass > 0.0 for o in self._objects):
            return
        self._objects = tuple(await self.client.scene())
        if self._base_follower is None and await self.client.simulation.bases():
            self._base_follower = asyncio.create_task(self._follow_base())
        self._scene_of = boot_id

    async def refresh_contacts(self) -> None:
        """Request what touches what, while somebody wants to know."""
        simulated = self._status is not None and self._status.simulation is not None
        if self.wants_contacts and simulated:
            self._contacts = tuple(await self.client.simulation.contacts())
        else:
            self._contacts = ()

    async def refresh_controllers(self) -> None:
        """Request the controllers, and the set-points that running controllers take."""
        controllers = tuple(await self.client.controllers())
        running = {c.name for c in controllers if c.state == "running"}
        for name in [name for name in self._elements if name not in running]:
            del self._elements[name]
        for name in running - self._elements.keys():
            self._elements[name] = await self._elements_of(name)
        hands = [n for n in running if moves_hand(self._elements[n])]
        self._messages = {name: await self._message_of(name) for name in hands}
        self._controllers = controllers
        self._heard()

    async def _elements_of(self, name: str) -> tuple[CommandElement, ...]:
        """Return the elements of a controller's set-point; empty without set-points.

        Raises:
            ApiError: The station does not answer.
        """
        try:
            return tuple((await self.client.last_command(name)).elements)
        except ApiError as error:
            if error.status == 0:
                raise
            return ()

    async def _message_of(self, name: str) -> str:
        """Return what keeps an end effector from its motion; empty when nothing does.

        Raises:
            ApiError: The station does not answer.
        """
        # A stream has no messages of a controller, so they are asked for.
        published = (await self.client.controller_state(name)).published
        return str(published.get("state", {}).get("message", ""))

    def _heard(self) -> None:
        self._heard_at = self.now()
        self._failure = ""

    async def _repeat(
        self, refresh: Callable[[], Awaitable[None]], period: float
    ) -> None:
        while True:
            wakes = self._wakes
            try:
                await refresh()
            except ApiError as error:
                self._failure = str(error)
            await self._pause(period, wakes)

    async def _follow_joints(self) -> None:
        async for frame in self._frames("joint_states", JOINT_RATE):
            joints = _joint_states(frame)
            if joints is not None:
                self._positions = {
                    name: position
                    for name, position in zip(joints.name, joints.position, strict=True)
                    if position is not None
                }
                self._moved.set()
                self._heard()

    async def _follow_base(self) -> None:
        async for frame in self._frames("scene", BASE_RATE, ("bases",)):
            scene = Scene.model_validate({"objects": [], **frame.data})
            # The names of the drawn joints have no robot in them: one base can move.
            self._base = scene.bases[0] if scene.bases else None
            self._moved.set()

    async def _follow_sample(self, name: str) -> None:
        async for frame in self._frames(f"controller_state/{name}", SAMPLE_RATE):
            sample = _controller_sample(frame)
            if sample is not None:
                self._samples[name] = sample

    async def _follow_arm(self, name: str) -> None:
        topic = f"robot_state/{name}"
        async for frame in self._frames(topic, ARM_RATE, ARM_FIELDS):
            self._arms[name] = arm_facts(frame.data)

    async def _frames(
        self, topic: str, rate: float, fields: Sequence[str] = ()
    ) -> AsyncIterator[StreamFrame]:
        """Yield a stream's frames; open the stream again when it ends or is refused.

        The client does not reconnect by itself, because the station may be another one
        when the stream is opened again.
        """
        while True:
            wakes = self._wakes
            with contextlib.suppress(ApiError):  # Polling says what is wrong.
                stream = self.client.stream(
                    topic, rate=rate, fields=fields, reconnect=False
                )
                async for frame in stream:
                    yield frame
            await self._pause(_RETRY, wakes)


def _position_limits(hardware: Hardware) -> dict[str, tuple[float, float]]:
    return {
        limits.joint: (limits.min_position, limits.max_position)
        for limits in hardware.limits
        if limits.min_position is not None and limits.max_position is not None
    }


def _joint_states(frame: StreamFrame) -> JointStates | None:
    """Return a frame's joints, or None, e.g. if a position is not finite."""
    try:
        return JointStates.model_validate({"stamp": frame.stamp, **frame.data})
    except ValidationError:
        return None


def _controller_sample(frame: StreamFrame) -> ControllerSample | None:
    """Return a frame's sample, or None if the controller has no sample."""
    try:
        return ControllerSample.model_validate({"stamp": frame.stamp, **frame.data})
    except ValidationError:
        return None
