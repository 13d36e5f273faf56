"""Collects the cycles of a trial from the ring of snapshots of a station."""

from itertools import pairwise

import numpy as np

from station.core.facade.station import Station
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
        samples = rows.columns_of(self._controller, len(self._joints))
        self._parts.append((rows.numbers[:, 2], states, samples))

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
