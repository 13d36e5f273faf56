"""Collects the cycles of a trial from the ring of snapshots of a station."""

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
        self._parts: list[dict[str, Array]] = []
        self._mode = ""
        self.reflexes = 0
        self.lost = 0

    def take(self) -> None:
        """Take the cycles since the last call; the ring keeps 4096."""
        snapshots, lost = self._facade.snapshots.read_since(self._cycle)
        self.lost += lost
        if not snapshots:
            return
        self._cycle = snapshots[-1].cycle
        for one in snapshots:
            self.reflexes += one.mode == _REFLEX != self._mode
            self._mode = one.mode
        width = len(self._joints)
        blank = np.full(width, np.nan)
        samples = [one.samples.get(self._controller) for one in snapshots]
        columns = self._columns
        part = {
            name: np.array([getattr(one, name) for one in snapshots])[:, columns]
            for name in ("position", "velocity", "effort")
        }
        for name in ("desired", "error", "output"):
            rows = [blank if s is None else getattr(s, name) for s in samples]
            part[name] = np.array([row if len(row) == width else blank for row in rows])
        part["stamp"] = np.array([one.stamp for one in snapshots])
        self._parts.append(part)

    def trace(self, *, is_live: bool = False) -> Trace:
        """Return everything taken so far, one cycle at least.

        Args:
            is_live: Whether the times are those of the cycles, of which some may be
                late; a stepped station has one per period.
        """
        period = self._facade.loop.period
        joined = {
            name: np.concatenate([part[name] for part in self._parts])
            for name in self._parts[0]
        }
        stamps = joined.pop("stamp")
        joints = [self._facade.joint_names[column] for column in self._columns]
        if is_live:
            time: Array = stamps - stamps[0]
        else:
            time = np.array([cycle * period for cycle in range(len(stamps))])
        return Trace(tuple(joints), period, time, **joined)
