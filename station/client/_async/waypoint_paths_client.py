"""The client of a station's waypoint paths."""

from collections.abc import Sequence
from functools import partial

from station.client._async.connection import AsyncConnection
from station.client.routes import segment
from station.wire import (
    CaptureRequest,
    LastPlayback,
    Playback,
    PlaybackPatch,
    PlayRequest,
    Waypoint,
    WaypointPath,
    WaypointPathRequest,
    WaypointPaths,
    WaypointRequest,
)

_PATH, _PLAYBACK = "/waypoint-paths", "/playback"


class AsyncWaypointPathsClient:
    """Waypoint paths on the station's disk, and their playing: `client.waypoint_paths`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved paths."""
        return (await self._connection.get(_PATH, WaypointPaths)).waypoint_paths

    async def get(self, name: str) -> WaypointPath:
        """Return a path with its waypoints."""
        return await self._connection.get(_path(name), WaypointPath)

    async def save(
        self, name: str, waypoints: Sequence[Waypoint | WaypointRequest]
    ) -> WaypointPath:
        """Save the waypoints of a path; a path of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            waypoints: The waypoints, in the order in which they are passed.
        """
        read = partial(WaypointRequest.model_validate, from_attributes=True)
        found = [read(waypoint) for waypoint in waypoints]
        request = WaypointPathRequest(waypoints=found)
        return await self._connection.send("PUT", _path(name), WaypointPath, request)

    async def delete(self, name: str) -> WaypointPath:
        """Delete a path; return what it was."""
        return await self._connection.send("DELETE", _path(name), WaypointPath)

    async def capture(
        self, name: str, waypoint: str | None = None, duration: float = 2.0
    ) -> WaypointPath:
        """Add where the joints are now to the end of a path; the first one makes it.

        Args:
            name: The path.
            waypoint: Name of the waypoint; `point N` when None.
            duration: Time to it from the waypoint before [s], above 0.
        """
        request = CaptureRequest(name=waypoint, duration=duration)
        path = f"{_path(name)}/capture"
        return await self._connection.send("POST", path, WaypointPath, request)

    async def play(
        self,
        name: str,
        *,
        controller: str | None = None,
        speed: float = 1.0,
        loop: bool = False,
    ) -> Playback:
        """Move along a path; `playback` says how far it is.

        Args:
            name: The path.
            controller: The trajectory controller; the one that runs when None.
            speed: Factor of all speeds, 0.05 to 2.
            loop: Begin again at the end.
        """
        request = PlayRequest(controller=controller, speed=speed, loop=loop)
        path = f"{_path(name)}/play"
        return await self._connection.send("POST", path, Playback, request)

    async def playback(self) -> Playback | None:
        """Return the path that plays or played last; None when none was played."""
        return (await self._connection.get(_PLAYBACK, LastPlayback)).playback

    async def change(
        self,
        *,
        paused: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> Playback:
        """Pause or resume the path that plays; change its speed, or whether it loops.

        Args:
            paused: True holds, false goes on, None leaves it.
            speed: Factor of all speeds, 0.05 to 2; None leaves it.
            loop: Whether it begins again at its end; None leaves it.
        """
        request = PlaybackPatch(paused=paused, speed=speed, loop=loop)
        return await self._connection.send("PATCH", _PLAYBACK, Playback, request)

    async def cancel(self) -> Playback:
        """End the path that plays; the robot holds where it is."""
        return await self._connection.send("DELETE", _PLAYBACK, Playback)


def _path(name: str) -> str:
    return f"{_PATH}/{segment(name)}"
