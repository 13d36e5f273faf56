"""The trace of a trial, cycle by cycle, and its recorder."""

import io
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from station.core.facade.station import Station
from station.trials.errors import ExperimentError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trace:
    """The k cycles of a trial, for the n joints of its controller.

    Attributes:
        joints: Names of the joints.
        period: Time between two cycles [s], > 0.
        time: Time since the trial began [s], shape (k,).
        position: Measured positions [rad or m], shape (k, n).
        velocity: Measured velocities [rad/s or m/s], shape (k, n).
        effort: Measured efforts [Nm or N], shape (k, n).
        desired: Set-points of the controller [unit of the set-point], shape (k, n); NaN
            in cycles in which the controller did not run.
        error: Control errors as the controller computes them [unit of the set-point],
            shape (k, n).
        output: Commands of the controller [unit of its interface], shape (k, n).
    """

    joints: tuple[str, ...]
    period: float
    time: Array
    position: Array
    velocity: Array
    effort: Array
    desired: Array
    error: Array
    output: Array

    def of_joint(self, joint: str) -> Self:
        """Return the trace of one of the joints only."""
        chosen = slice(self.joints.index(joint), self.joints.index(joint) + 1)
        names = ("position", "velocity", "effort", "desired", "error", "output")
        columns = {name: getattr(self, name)[:, chosen] for name in names}
        return replace(self, joints=(joint,), **columns)

    def until(self, cycles: int) -> Self:
        """Return the first cycles of the trace."""
        names = (
            *("time", "position", "velocity"),
            *("effort", "desired", "error", "output"),
        )
        return replace(self, **{name: getattr(self, name)[:cycles] for name in names})

    def to_bytes(self) -> bytes:
        """Return the trace as a compressed `.npz` file."""
        file = io.BytesIO()
        values = {f.name: np.asarray(getattr(self, f.name)) for f in fields(self)}
        np.savez_compressed(file, allow_pickle=False, **values)
        return file.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Return the trace that `to_bytes` wrote."""
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            arrays = {f.name: file[f.name] for f in fields(cls)}
        joints = tuple(str(name) for name in arrays.pop("joints"))
        return cls(joints, float(arrays.pop("period")), **arrays)


def read_trace(path: Path) -> Trace:
    """Return the trace in a file.

    Raises:
        ExperimentError: The file cannot be read.
    """
    try:
        return Trace.from_bytes(path.read_bytes())
    except (OSError, ValueError, KeyError) as error:
        raise ExperimentError(
            f"The recording {path} cannot be read: {error}.",
            remedy="`station identify --record FILE.npz` writes such a file.",
        ) from error


_REFLEX = "reflex"


class TraceRecorder:
    """Collects the samples of a controller and its joints from the next cycle on.

    Args:
        facade: The station.
        controller: The controller, which is loaded.

    Attributes:
        reflexes: Number of reflexes of arms.
        lost: Cycles that the ring overwrote before they were read.
    """

    def __init__(self, facade: Station, controller: str) -> None:
        self._facade = facade
        self._controller = controller
        names = facade.joint_names
        self._joints = facade.manager.get_controller(controller).joint_names
        self._columns = [names.index(joint) for joint in self._joints if joint in names]
        self._cycle = facade.loop.cycle
        self._parts: list[tuple[Array, Array, Array]] = []
        self._mode = ""
        self.reflexes = 0
        self.lost = 0

    def take(self) -> None:
        """Read the cycles since the last call from the ring, which keeps 4096."""
        rows = self._facade.snapshots.rows_since(self._cycle)
        self.lost += rows.lost
        if not rows.modes:
            return
        self._cycle = int(rows.numbers[-1, 0])
        for before, mode in pairwise([self._mode, *rows.modes]):
            self.reflexes += mode == _REFLEX != before
        self._mode = rows.modes[-1]
        states = rows.states_of_joints()[:, :, self._columns]
        samples = rows.columns_of(self._controller, len(self._joints))
        self._parts.append((rows.numbers[:, 2], states, samples))

    def trace(self, *, is_live: bool = False) -> Trace:
        """Return the trace so far, with one cycle at least.

        Args:
            is_live: Whether to use the times of the cycles, some of which may be late;
                in a stepped station one cycle follows each period.
        """
        period = self._facade.loop.period
        stamps, states, samples = (
            np.concatenate(parts) for parts in zip(*self._parts, strict=True)
        )
        joints = [self._facade.joint_names[column] for column in self._columns]
        if is_live:
            time: Array = stamps - stamps[0]
        else:
            time = np.array([cycle * period for cycle in range(len(stamps))])
        position, velocity, effort = np.moveaxis(states, 1, 0)
        desired, _, error, output = np.moveaxis(samples, 1, 0)
        return Trace(
            joints=tuple(joints),
            period=period,
            time=time,
            position=position,
            velocity=velocity,
            effort=effort,
            desired=desired,
            error=error,
            output=output,
        )
