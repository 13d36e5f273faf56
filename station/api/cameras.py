"""Pictures of cameras, which a separate process draws while a client reads them."""

import asyncio
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass

import anyio
import anyio.to_thread

from station.config.models import CameraSection
from station.core.errors import StationError, suggest
from station.core.scheduling import ordinary_priority
from station.reports import CameraReport

RENDERER = (sys.executable, "-m", "station.app.camera_renderer")
FIRST_PICTURE = 30.0
"""Longest wait for a picture [s], because the process must start and read meshes."""
AGAIN_AFTER = 10.0
"""Time after which a failed renderer is started again [s]."""
_ASK_EVERY = 0.5
_FRESH = 0.5
"""Age from which a picture is stale, if no newer one has come [s]."""
_LOOK_EVERY = 0.02


class CameraNotFoundError(StationError, KeyError):
    """There is no camera of that name."""

    code = "camera_not_found"


class CameraError(StationError, RuntimeError):
    """A camera has no picture."""

    code = "camera_failed"


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of a camera.

    Attributes:
        number: Number of the picture, counted over all cameras.
        stamp: Station time of the picture [s].
        jpeg: Content of the JPEG file.
        drawn_at: When the picture came, on the monotonic clock [s].
    """

    number: int
    stamp: float
    jpeg: bytes
    drawn_at: float


class Cameras:
    """The cameras of a station. Their renderer runs while a client reads pictures.

    Args:
        cameras: The cameras by name.
        assign: Function that returns the station's address and its robots; called at
            each start of the renderer.
        command: The command line of the renderer.
    """

    def __init__(
        self,
        cameras: Mapping[str, CameraSection] | None = None,
        assign: Callable[[], Mapping[str, object]] = dict,
        command: tuple[str, ...] = RENDERER,
    ) -> None:
        self._cameras = dict(cameras or {})
        self._assign = assign
        self._command = command
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None
        self._newest: dict[str, Picture] = {}
        self._asked_at: dict[str, float] = {}
        self._number = 0
        self._fault = ""
        self._failed_at = -AGAIN_AFTER

    def reports(self) -> list[CameraReport]:
        """Return the cameras, each with the reason why it has no pictures, if any."""
        return [
            CameraReport(
                name,
                camera.frame,
                camera.width,
                camera.height,
                camera.rate,
                self._fault,
            )
            for name, camera in self._cameras.items()
        ]

    async def picture(self, name: str, after: int | None = None) -> Picture:
        """Return the newest picture of a camera.

        Args:
            name: Its name.
            after: Number of a picture; only a later one is returned. None accepts a
                picture that was drawn within the last period.

        Raises:
            CameraNotFoundError: There is no such camera.
            CameraError: The picture cannot be drawn, or not in time.
        """
        camera = self._cameras.get(name)
        if camera is None:
            raise CameraNotFoundError(
                f"There is no camera '{name}'.", remedy=suggest(name, self._cameras)
            )
        begun = time.monotonic()
        fresh = begun - 1.0 / camera.rate
        while True:
            newest = self._newest.get(name)
            if newest and (
                newest.drawn_at > fresh if after is None else newest.number > after
            ):
                return newest
            now = time.monotonic()
            if now - self._asked_at.get(name, -_ASK_EVERY) >= _ASK_EVERY:
                self._asked_at[name] = now
                await anyio.to_thread.run_sync(self._ask, name)
            if self._fault or now - begun > FIRST_PICTURE:
                raise CameraError(
                    f"The camera '{name}' cannot be drawn: "
                    f"{self._fault or 'no picture came in time'}.",
                    remedy="Pictures need the extras `sim` and `ui`, and OpenGL that "
                    "needs no screen: EGL (libegl1), or MUJOCO_GL=osmesa.",
                )
            await anyio.sleep(_LOOK_EVERY)

    def glance(self, name: str) -> Picture | None:
        """Return the newest picture if it is fresh, and request the next one.

        Args:
            name: Name of a camera.
        """
        now = time.monotonic()
        if now - self._asked_at.get(name, -_ASK_EVERY) >= _ASK_EVERY:
            self._asked_at[name] = now
            asyncio.get_running_loop().run_in_executor(None, self._ask, name)
        newest = self._newest.get(name)
        fresh = now - _FRESH - 1.0 / self._cameras[name].rate
        return newest if newest and newest.drawn_at > fresh else None

    async def pictures(self, name: str) -> AsyncIterator[Picture]:
        """Yield each picture of a camera once, until the camera fails."""
        number = -1
        while True:
            found = await self.picture(name, number)
            number = found.number
            yield found

    def close(self) -> None:
        """End the renderer's process."""
        with self._lock:
            if self._process is not None:
                self._process.kill()
            if self._reader is not None:
                self._reader.join()

    def _ask(self, name: str) -> None:
        """Tell the renderer that a client reads pictures; start it if necessary."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                if time.monotonic() - self._failed_at < AGAIN_AFTER:
                    return
                self._start()
            process = self._process
            if process is not None and process.stdin is not None:
                try:
                    process.stdin.write(f"{name}\n".encode())
                    process.stdin.flush()
                except (OSError, ValueError):
                    return  # it has just ended, and will be restarted

    def _start(self) -> None:
        self._fault = ""
        # Limit software rendering to one processor, because the control loop needs one.
        surroundings = {"MUJOCO_GL": "egl", "LP_NUM_THREADS": "1", **os.environ}
        with ordinary_priority():
            self._process = process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=surroundings,
                start_new_session=True,
            )
        cameras = {name: one.model_dump() for name, one in self._cameras.items()}
        assignment = {**self._assign(), "cameras": cameras}
        if process.stdin is not None:
            process.stdin.write(json.dumps(assignment).encode() + b"\n")
        self._reader = threading.Thread(
            target=self._read, args=(process,), name="cameras", daemon=True
        )
        self._reader.start()

    def _read(self, process: "subprocess.Popen[bytes]") -> None:
        """Read pictures from the renderer until it ends."""
        fault = ""
        with process:
            while process.stdout is not None and (line := process.stdout.readline()):
                header = json.loads(line)
                content = process.stdout.read(header["size"])
                if "error" in header:
                    fault = header["error"]
                    continue
                self._number += 1
                self._newest[header["name"]] = Picture(
                    self._number, header["stamp"], content, time.monotonic()
                )
        if process.returncode or fault:
            self._failed_at = time.monotonic()
            ended = f"the renderer ended with exit code {process.returncode}"
            self._fault = fault or ended
