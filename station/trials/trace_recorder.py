"""Collects the cycles of a trial from the ring of snapshots of a station."""

from itertools import pairwise

import numpy as np

from station.core.control.controller import unpack_sample
from station.core.facade.station import Station
from station.core.loop.snapshot import Rows, Samples
from station.trials.trace import Array, Trace

_REFLEX = "reflex"


class TraceRecorder:
    """Collects what a controller and its joints do, beginning with the next cycle.

    Args:
        facade: The station.
        controller: The controller, which is loaded.

    Attributes:
        reflexes: How often an arm fell into its reflex.
        lost: Cycles that were overwritten before they were taken.
    """

    def __init__(self, facade: Station, controller: str) -> None:
        self._facade = facade
        self._controller = controller
        names = facade.joint_names
        self._joints = facade.manager.get_controller(controller).joint_names
        self._columns = [names.index(joint) for joint in self._joints if joint in names]
        self._cycle = facade.loop.cycle
        self._blank = np.full(4 * len(self._joints), np.nan).tobytes()
        self._parts: list[tuple[Array, Array, Array]] = []
        self._mode = ""
        self.reflexes = 0
        self.lost = 0

    def take(self) -> None:
        """Take the cycles since the last call; the ring keeps 4096."""
        rows = self._facade.snapshots.rows_since(self._cycle)
        self.lost += rows.lost
        if not rows.modes:
            return
        self._cycle = int(rows.numbers[-1, 0])
        for before, mode in pairwise([self._mode, *rows.modes]):
            self.reflexes += mode == _REFLEX != before
        self._mode = rows.modes[-1]
        states = rows.states_of_joints()[:, :, self._columns]
        self._parts.append((rows.numbers[:, 2], states, self._samples_of(rows)))

    def _samples_of(self, rows: Rows) -> Array:
        """Return the columns of the controller's samples, shape (k, 4, n)."""
        shape = (len(rows.modes), 4, len(self._joints))
        found = rows.columns_of(self._controller, shape[2])
        if found is None:
            samples = [rows.record(k)[6] for k in range(shape[0])]
            memory = b"".join(map(self._memory_of, samples))
            found = np.frombuffer(memory).reshape(shape)
        return found

    def _memory_of(self, samples: Samples) -> bytes:
        """Return the four columns of the controller in a cycle as doubles.

        They are NaN if it did not run, or has columns of another length.
        """
        sample = samples.get(self._controller)
        memory = b"" if sample is None else unpack_sample(sample).memory()
        return memory if len(memory) == len(self._blank) else self._blank

    def trace(self, *, is_live: bool = False) -> Trace:
        """Return everything taken so far, one cycle at least.

        Args:
            is_live: Whether the times are those of the cycles, of which some may be
                late; a stepped station has one per period.
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
