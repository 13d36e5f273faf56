"""The trace of a trial, cycle by cycle."""

import io
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from station.trials.errors import ExperimentError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trace:
    """The cycles of a trial, k of them, for the n joints of its controller.

    Attributes:
        joints: Names of the joints.
        period: Time between two cycles [s], > 0.
        time: Time since the trial began [s], shape (k,).
        position: Measured positions [rad or m], shape (k, n).
        velocity: Measured velocities [rad/s or m/s], shape (k, n).
        effort: Measured efforts [Nm or N], shape (k, n).
        desired: Set-points of the controller [its unit], shape (k, n); NaN in cycles in
            which it did not run.
        error: Differences from them, as the controller computes them, shape (k, n).
        output: What it commanded [unit of its interface], shape (k, n).
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
        """Return the trace of one of the joints alone."""
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
    """Return the motion in a file.

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
