"""Read the messages, texts, inputs and joint trajectories of recordings."""

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.reader import McapReader, make_reader
from numpy.typing import NDArray

from station.core.errors import RecordingDamagedError, RecordingFileError
from station.core.user_files import open_regular
from station.records.cdr import Values
from station.records.cycle_messages import CYCLES, JOINT_STATES
from station.records.mcap_scan import DAMAGE
from station.records.messages import TYPES


@dataclass(frozen=True, slots=True)
class Trajectory:
    """The joint states of a recording in every cycle.

    Attributes:
        names: Names of the joints.
        cycle: Numbers of the cycles, shape (m,).
        time: Station time [s], shape (m,).
        period: Time since the cycle before [s], shape (m,).
        position: Positions [rad or m], shape (m, n).
        velocity: Velocities [rad/s or m/s], shape (m, n).
        effort: Efforts [Nm or N], shape (m, n).
    """

    names: tuple[str, ...]
    cycle: NDArray[np.int64]
    time: NDArray[np.float64]
    period: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    effort: NDArray[np.float64]

    def decimated(self, rate: float) -> "Trajectory":
        """Return some of the cycles, the first among them.

        Args:
            rate: Cycles per second of station time [Hz], > 0.
        """
        if not len(self.time):
            return self
        due = np.floor((self.time - self.time[0]) * rate + 1e-6)
        chosen = np.flatnonzero(np.diff(due, prepend=-1.0) > 0.0)
        return Trajectory(
            self.names,
            self.cycle[chosen],
            self.time[chosen],
            self.period[chosen],
            self.position[chosen],
            self.velocity[chosen],
            self.effort[chosen],
        )


def _opened(path: Path) -> BinaryIO:
    """Open a recording to be read.

    Raises:
        RecordingFileError: The file does not exist, or may not be read.
    """
    try:
        return os.fdopen(open_regular(path), "rb")
    except OSError as error:
        raise RecordingFileError(
            f"{path} cannot be read: {error.strerror or error}.",
            remedy="Give the path of an MCAP file of a station.",
        ) from error


@contextmanager
def reading(path: Path) -> Iterator[BinaryIO]:
    """Open a recording for reading in the body of a `with`.

    Raises:
        RecordingFileError: The file does not exist, or may not be read.
        RecordingDamagedError: The file is not a complete recording.
    """
    with _opened(path) as file:
        try:
            yield file
        except DAMAGE as error:
            raise RecordingDamagedError(
                f"{path} cannot be read, it is damaged: {error!r:.200}.",
                remedy="`station recover-file` keeps what is whole of it.",
            ) from error


def read_messages(
    path: Path, topics: Iterable[str] | None = None, *, is_reverse: bool = False
) -> Iterator[tuple[str, Values]]:
    """Yield topic and content of the messages of a recording, in their order of time.

    Args:
        path: The file.
        topics: Channels; all when None.
        is_reverse: Whether to begin with the newest message.

    Raises:
        RecordingFileError: The file is not a complete recording.
    """
    chosen = None if topics is None else list(topics)
    with reading(path) as file:
        reader: McapReader = make_reader(file, validate_crcs=True)
        for schema, channel, message in reader.iter_messages(
            topics=chosen, reverse=is_reverse
        ):
            kind = None if schema is None else TYPES.get(schema.name)
            if kind is not None:
                yield channel.topic, kind.decode(message.data)


def read_texts(path: Path, topic: str) -> list[str]:
    """Return the texts of a channel, e.g. `/configuration`."""
    return [str(message["data"]) for _, message in read_messages(path, [topic])]


def read_inputs(path: Path) -> list[dict[str, object]]:
    """Return the inputs of the station, in the order of its cycles."""
    return [json.loads(text) for text in read_texts(path, "/inputs")]


def read_trajectory(path: Path) -> Trajectory:
    """Return the joints of a recording in every cycle.

    Raises:
        RecordingFileError: The file is not a complete recording.
    """
    names: tuple[str, ...] = ()
    cycles: list[tuple[int, float, float]] = []
    rows: list[list[float]] = []
    for topic, message in read_messages(path, [CYCLES, JOINT_STATES]):
        if topic == CYCLES:
            cycles.append((message["cycle"], message["time"], message["period"]))
        else:
            names = tuple(message["name"])
            columns = (message["position"], message["velocity"], message["effort"])
            rows.append([value for column in columns for value in column])
    joints = np.array(rows, dtype=np.float64).reshape(len(rows), 3, len(names))
    numbers = [cycle for cycle, _, _ in cycles]
    return Trajectory(
        names,
        np.array(numbers, dtype=np.int64),
        np.array([time for _, time, _ in cycles], dtype=np.float64),
        np.array([period for _, _, period in cycles], dtype=np.float64),
        joints[:, 0],
        joints[:, 1],
        joints[:, 2],
    )
