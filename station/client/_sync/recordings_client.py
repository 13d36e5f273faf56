# Generated from _async/recordings_client.py by tools/generate_client.py.
"""The client of a station's recordings, and of its incidents."""

from collections.abc import Iterable
from pathlib import Path

from station.client._sync.alarms_client import AlarmsClient
from station.client._sync.connection import Connection, Query
from station.client._sync.experiments_client import ExperimentsClient
from station.client._sync.gain_sets_client import GainSetsClient
from station.client._sync.waypoint_paths_client import WaypointPathsClient
from station.client.routes import segment
from station.wire import Recording, RecordingRequest, Recordings, Trajectory

_RECORDINGS, _INCIDENTS = "/recordings", "/incidents"


class _Files:
    """What recordings and incidents have in common.

    Args:
        connection: The connection to the station.
        path: Where they are.
    """

    def __init__(self, connection: Connection, path: str) -> None:
        self._connection = connection
        self._path = path

    def list(self) -> list[Recording]:
        """Return all, the oldest first."""
        return (self._connection.get(self._path, Recordings)).recordings

    def get(self, identifier: str) -> Recording:
        """Return what is known of one."""
        return self._connection.get(self._of(identifier), Recording)

    def trajectory(self, identifier: str, rate: float = 30.0) -> Trajectory:
        """Return the joint positions of one that has ended.

        Args:
            identifier: Which one.
            rate: Cycles per second of station time [Hz].
        """
        path = f"{self._of(identifier)}/trajectory"
        return self._connection.get(path, Trajectory, {"rate": repr(rate)})

    def download(self, identifier: str, target: Path | str) -> Path:
        """Write the MCAP file of one that has ended to a new file; return its path.

        Args:
            identifier: Which one.
            target: The file to be; it is not there yet.

        Raises:
            FileExistsError: There is such a file.
        """
        target = Path(target)
        self._connection.download(f"{self._of(identifier)}/file", target)
        return target

    def download_table(
        self,
        identifier: str,
        target: Path | str,
        *,
        channels: Iterable[str] = (),
        joints: Iterable[str] = (),
        rate: float | None = None,
    ) -> Path:
        """Write one that has ended as CSV to a new file; return its path.

        Args:
            identifier: Which one.
            target: The file to be; it is not there yet.
            channels: Channels, or channels with a field, e.g. `joint_states/position`;
                all when there is none.
            joints: Joints, or other elements with a name; all when there is none.
            rate: Rows per second of station time [Hz], > 0; every cycle when None.

        Raises:
            FileExistsError: There is such a file.
        """
        target = Path(target)
        query: Query = {"channels": [*channels], "joints": [*joints]}
        if rate is not None:
            query = {**query, "rate": repr(rate)}
        self._connection.download(f"{self._of(identifier)}/table", target, query)
        return target

    def _of(self, identifier: str) -> str:
        return f"{self._path}/{segment(identifier)}"


class RecordingsClient(_Files):
    """Recordings of every cycle on the station's disk: `client.recordings`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: Connection) -> None:
        super().__init__(connection, _RECORDINGS)

    def start(self, name: str = "", note: str = "") -> Recording:
        """Begin to record with the next cycle; one recording runs at a time.

        Args:
            name: Up to 80 letters, digits, `_`, `.` and `-`.
            note: For the record.
        """
        request = RecordingRequest(name=name, note=note)
        return self._connection.send("POST", self._path, Recording, request)

    def stop(self, identifier: str | None = None) -> Recording:
        """End a recording; its file is whole then.

        Args:
            identifier: Which one; the one that runs when None.

        Raises:
            LookupError: None runs.
        """
        if identifier is None:
            running = [r for r in self.list() if r.state == "recording"]
            if not running:
                raise LookupError("Nothing is being recorded.")
            identifier = running[-1].identifier
        path = f"{self._of(identifier)}/stop"
        return self._connection.send("POST", path, Recording)

    def delete(self, identifier: str) -> Recording:
        """Delete a recording that does not run; return what it was."""
        return self._connection.send("DELETE", self._of(identifier), Recording)


class IncidentsClient(_Files):
    """What the station kept of stops, reflexes and faults: `client.incidents`.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: Connection) -> None:
        super().__init__(connection, _INCIDENTS)


def kept_by_station(
    connection: Connection,
) -> tuple[
    GainSetsClient,
    RecordingsClient,
    IncidentsClient,
    ExperimentsClient,
    WaypointPathsClient,
    AlarmsClient,
]:
    """Return the clients of what a station keeps, on its disk or while it runs.

    Args:
        connection: The connection to the station.
    """
    return (
        GainSetsClient(connection),
        RecordingsClient(connection),
        IncidentsClient(connection),
        ExperimentsClient(connection),
        WaypointPathsClient(connection),
        AlarmsClient(connection),
    )
