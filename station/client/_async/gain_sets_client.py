"""The client of a station's gain sets."""

from collections.abc import Mapping, Sequence

from station.client._async.connection import AsyncConnection
from station.client.routes import segment
from station.wire import GainsChange, GainsChanges, GainSet, GainSetRequest, GainSets
from station.wire.gain_sets import GainsOfControllersPatch

_PATH = "/gain-sets"


class AsyncGainSetsClient:
    """Named sets of gains on the station's disk: `client.gain_sets`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved sets."""
        return (await self._connection.get(_PATH, GainSets)).gain_sets

    async def get(self, name: str) -> GainSet:
        """Return a set, and where it differs from the gains in force."""
        return await self._connection.get(_path(name), GainSet)

    async def save(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> GainSet:
        """Save the gains in force under a name; a set of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Whose gains; those of all loaded controllers when None.
        """
        request = _chosen(controllers)
        return await self._connection.send("PUT", _path(name), GainSet, request)

    async def delete(self, name: str) -> GainSet:
        """Delete a set; return what it was."""
        return await self._connection.send("DELETE", _path(name), GainSet)

    async def apply(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> Mapping[str, GainsChange]:
        """Put a set into force in one cycle; return the change of each controller.

        Args:
            name: The set.
            controllers: Whose gains; those of all controllers of the set when None.
        """
        path, request = f"{_path(name)}/apply", _chosen(controllers)
        answer = await self._connection.send("POST", path, GainsChanges, request)
        return answer.changes

    async def set_gains(
        self,
        changes: Mapping[str, Mapping[str, float]],
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, GainsChange]:
        """Change gains of several controllers in one cycle; the others stay.

        Args:
            changes: New values by controller and name.
            revisions: Refuse when the gains of a controller have another revision.
        """
        request = GainsOfControllersPatch(
            changes={name: dict(values) for name, values in changes.items()},
            revisions=None if revisions is None else dict(revisions),
        )
        answer = await self._connection.send("PATCH", "/gains", GainsChanges, request)
        return answer.changes

    async def undo(self) -> Mapping[str, GainsChange]:
        """Take the last change of gains back; return the change of each controller."""
        answer = await self._connection.send("POST", f"{_PATH}/undo", GainsChanges)
        return answer.changes


def _path(name: str) -> str:
    return f"{_PATH}/{segment(name)}"


def _chosen(controllers: Sequence[str] | None) -> GainSetRequest:
    if controllers is None:
        return GainSetRequest()
    return GainSetRequest(controllers=list(controllers))
