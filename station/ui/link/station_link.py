"""Keep up with a station by its streams and by polls.

Everything here runs on one event loop. A request that fails is repeated until it
succeeds; meanwhile the age of the data grows, and the panels show the data as old.
"""

import asyncio
import contextlib
import math
import time
from collections.abc import (
    AsyncIterator,
    Awaitable,
    Callable,
    Collection,
    Coroutine,
    Sequence,
)
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from station import wire
from station.client import ApiError, AsyncStationClient
from station.ui.link.station_view import ARM_FIELDS, StationView, arm_facts, moves_hand

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
_STILL_SCENE_PERIOD = 0.25
"""Time between two requests for objects that only people move, add and remove [s]."""
_RETRY = 0.5
_SAMPLES, _ARMS, _SCENE = "controller_state/", "robot_state/", "scene"


class StationLink:
    """The dashboard's knowledge of the station, kept up to date by `run`.

    Args:
        client: The station; owned by the caller.
        now: Monotonic clock [s].
        sliding: The joints whose positions are lengths.

    Attributes:
        client: As given.
        now: As given.
        wants_contacts: Whether a browser shows the contacts of a simulated world.
    """

    def __init__(
        self,
        client: AsyncStationClient,
        now: Callable[[], float] = time.monotonic,
        sliding: Collection[str] = (),
    ) -> None:
        self.client = client
        self.now = now
        self.wants_contacts = False
        # Replaced as a whole, so that any thread may read it.
        self._view = StationView(sliding=frozenset(sliding))
        self._scene_at = -math.inf
        self._scene_of = ""  # the boot_id of the station that it comes from
        self._limits_of = ""
        self._followers: dict[str, asyncio.Task[None]] = {}  # by topic
        self._moved = asyncio.Event()
        self._woken = asyncio.Event()
        self._wakes = 0

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
        """Return a frozen view of the newest data; callable by any thread."""
        return replace(self._view, now=self.now())

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
            followers = list(self._followers.values())
            for follower in followers:
                follower.cancel()
            await asyncio.gather(*followers, return_exceptions=True)

    def wake(self) -> None:
        """Ask the station at once, ahead of the next regular request."""
        self._wakes += 1
        self._woken.set()
        self._woken.clear()

    async def _pause(self, seconds: float, wakes: int) -> None:
        """Wait, at most until `wake` is called.

        Args:
            seconds: Longest wait [s].
            wakes: Value of `_wakes` before the request that this pause follows. If it
                has changed, the request went to the former station, and nothing waits.
        """
        if wakes != self._wakes:
            return
        # Not `wait_for`: before Python 3.12 it may swallow a cancellation.
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._woken.wait()

    def watch(self, names: Collection[str]) -> None:
        """Follow the samples of exactly these controllers."""
        self._follow_only(_SAMPLES, names, self._follow_sample)
        samples = self._view.samples
        self._note(samples={name: samples[name] for name in samples if name in names})

    def _follow_only(
        self,
        kind: str,
        names: Collection[str],
        follow: Callable[[str], Coroutine[None, None, None]],
    ) -> None:
        """Follow the streams of one kind with exactly these names."""
        topics = {kind + name: name for name in names}
        for topic in list(self._followers):
            if topic.startswith(kind) and topic not in topics:
                self._followers.pop(topic).cancel()
        for topic, name in topics.items():
            task = self._followers.get(topic)
            if task is None or task.done():
                self._followers[topic] = asyncio.create_task(follow(name))

    async def refresh_status(self) -> None:
        """Request the status; after a restart of the station, request everything."""
        status = await self.client.status()
        before = self._view.status
        # Controllers of the next station may have other elements under the same names.
        restarted = before is not None and status.boot_id != before.boot_id
        if restarted or not self._view.types:
            types = tuple(await self.client.controller_types())
            self._note(elements={}, types=types)
        self._hear(status=status)
        arms = {arm.arm_id for arm in status.robots}
        self._follow_only(_ARMS, arms, self._follow_arm)
        known = self._view.arms
        self._note(arms={name: known[name] for name in known if name in arms})
        if self._limits_of != status.boot_id:
            self._note(limits=_position_limits(await self.client.hardware()))
            self._limits_of = status.boot_id

    async def refresh_scene(self) -> None:
        """Request the objects of the scene; less often if none can move by itself."""
        status = self._view.status
        boot_id = "" if status is None else status.boot_id
        is_still = not any(thing.mass > 0.0 for thing in self._view.objects)
        is_early = self.now() - self._scene_at < _STILL_SCENE_PERIOD
        if self._scene_of == boot_id and is_still and is_early:
            return
        self._scene_at = self.now()
        self._note(objects=tuple(await self.client.scene()))
        if self._scene_of != boot_id and await self.client.simulation.bases():
            self._follow_only(_SCENE, {""}, self._follow_base)
        self._scene_of = boot_id

    async def refresh_contacts(self) -> None:
        """Request the contacts while a layer shows them."""
        status = self._view.status
        simulated = status is not None and status.simulation is not None
        contacts: tuple[wire.Contact, ...] = ()
        if self.wants_contacts and simulated:
            contacts = tuple(await self.client.simulation.contacts())
        self._note(contacts=contacts)

    async def refresh_controllers(self) -> None:
        """Request the controllers, and the set-points that running controllers take."""
        controllers = tuple(await self.client.controllers())
        running = {c.name for c in controllers if c.state == "running"}
        new = {
            name: await self._elements_of(name)
            for name in running - self._view.elements.keys()
        }
        elements = {**self._view.elements, **new}
        hands = [n for n in running if moves_hand(elements.get(n, ()))]
        messages = {name: await self._message_of(name) for name in hands}
        # Read again: after a restart of the station the former elements are forgotten
        # while the answers are awaited.
        elements = {**self._view.elements, **new}
        self._hear(
            controllers=controllers,
            elements={n: elements[n] for n in elements if n in running},
            messages=messages,
        )

    async def _elements_of(self, name: str) -> tuple[wire.CommandElement, ...]:
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
        """Return the obstacle to an end effector's motion; empty when there is none.

        Raises:
            ApiError: The station does not answer.
        """
        # A stream has no messages of a controller, so they are asked for.
        published = (await self.client.controller_state(name)).published
        return str(published.get("state", {}).get("message", ""))

    def _note(self, **changes: Any) -> None:  # noqa: ANN401 - fields of the view
        self._view = replace(self._view, **changes)

    def _hear(self, **changes: Any) -> None:  # noqa: ANN401 - fields of the view
        """Note new values, and the time of their arrival."""
        self._note(heard_at=self.now(), failure="", **changes)

    async def _repeat(
        self, refresh: Callable[[], Awaitable[None]], period: float
    ) -> None:
        while True:
            wakes = self._wakes
            try:
                await refresh()
            except ApiError as error:
                self._note(failure=str(error))
            await self._pause(period, wakes)

    async def _follow_joints(self) -> None:
        async for frame in self._frames("joint_states", JOINT_RATE):
            joints = _joint_states(frame)
            if joints is not None:
                pairs = zip(joints.name, joints.position, strict=True)
                self._hear(positions={n: q for n, q in pairs if q is not None})
                self._moved.set()

    async def _follow_base(self, _name: str) -> None:
        async for frame in self._frames(_SCENE, BASE_RATE, ("bases",)):
            scene = wire.Scene.model_validate({"objects": [], **frame.data})
            # The names of the drawn joints have no robot in them: one base can move.
            self._note(base=scene.bases[0] if scene.bases else None)
            self._moved.set()

    async def _follow_sample(self, name: str) -> None:
        async for frame in self._frames(_SAMPLES + name, SAMPLE_RATE):
            sample = _controller_sample(frame)
            if sample is not None:
                self._note(samples={**self._view.samples, name: sample})

    async def _follow_arm(self, name: str) -> None:
        async for frame in self._frames(_ARMS + name, ARM_RATE, ARM_FIELDS):
            self._note(arms={**self._view.arms, name: arm_facts(frame.data)})

    async def _frames(
        self, topic: str, rate: float, fields: Sequence[str] = ()
    ) -> AsyncIterator[wire.StreamFrame]:
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


def _position_limits(hardware: wire.Hardware) -> dict[str, tuple[float, float]]:
    return {
        limits.joint: (limits.min_position, limits.max_position)
        for limits in hardware.limits
        if limits.min_position is not None and limits.max_position is not None
    }


def _joint_states(frame: wire.StreamFrame) -> wire.JointStates | None:
    """Return a frame's joints, or None, e.g. if a position is not finite."""
    try:
        return wire.JointStates.model_validate({"stamp": frame.stamp, **frame.data})
    except ValidationError:
        return None


def _controller_sample(frame: wire.StreamFrame) -> wire.ControllerSample | None:
    """Return a frame's sample, or None if the controller has no sample."""
    try:
        return wire.ControllerSample.model_validate({
            "stamp": frame.stamp,
            **frame.data,
        })
    except ValidationError:
        return None
