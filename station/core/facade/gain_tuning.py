"""Read run-time parameters of controllers, change them in one cycle, and undo it."""

import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from station.core.control.controller_manager import ControllerManager
from station.core.control.tunables import Gains, Tunables
from station.core.errors import GainsChangedError, NothingToUndoError
from station.core.facade.input_log import InputLog
from station.core.loop.control_loop import ControlLoop
from station.reports import GainsChange

HISTORY = 100
"""Number of changes that can be taken back."""


@dataclass(frozen=True, slots=True)
class _Done:
    """A change that can be taken back.

    Attributes:
        tunables: The parameter objects of each controller; another object means that
            the controller was loaded anew.
        previous: The values before the change, by controller and name.
    """

    tunables: dict[str, Tunables]
    previous: dict[str, dict[str, float]]


class GainTuning:
    """Changes the gains of one or several controllers in one cycle. Any thread.

    Args:
        loop: The loop.
        manager: Its controller manager.
        change_lock: Lock that is held while a controller is loaded or unloaded.
        inputs: Receives each change.
    """

    def __init__(
        self,
        loop: ControlLoop,
        manager: ControllerManager,
        change_lock: threading.Lock,
        inputs: InputLog | None = None,
    ) -> None:
        self._inputs = inputs or InputLog(loop)
        self._loop = loop
        self._manager = manager
        self._change_lock = change_lock
        self._revisions: dict[str, int] = {}
        self._history: deque[_Done] = deque(maxlen=HISTORY)

    def begin_revision(self, name: str) -> None:
        """Begin a revision for a loaded controller; the caller has the lock."""
        self._revisions[name] = self._revisions.get(name, 0) + 1

    def gains(self, name: str) -> Gains:
        """Return the run-time parameters of a controller.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        tunables = self._manager.get_controller(name).tunables
        revision = self._revisions.get(name, 0)
        return Gains(tunables.values, tunables.schema, revision)

    def all_gains(self) -> dict[str, dict[str, float]]:
        """Return the gains of all loaded controllers that have any, by controller."""
        found = {}
        for status in self._manager.controller_statistics():
            values = self._manager.get_controller(status.name).tunables.values
            if values:
                found[status.name] = dict(values)
        return found

    def set_gains(
        self,
        name: str,
        changes: Mapping[str, float],
        revision: int | None = None,
        *,
        remember: bool = True,
    ) -> GainsChange:
        """Change run-time parameters, all of them between the same two cycles.

        Args:
            name: The controller.
            changes: New values by name; other values stay.
            revision: Revision that the caller has read; None accepts any.
            remember: Whether `undo` can take the change back. A test that restores the
                gains itself sets this to false, so that `undo` takes back people's
                changes only.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
            GainsChangedError: `revision` is not the present one.
            InvalidGainError: A name or value is not allowed; nothing changed.
            LoopError: The loop died or hangs.
        """
        with self._change_lock:
            if revision is not None:
                self._check_revision(name, revision)
            return self._apply({name: changes}, remember=remember)[name]

    def set_many(
        self,
        changes: Mapping[str, Mapping[str, float]],
        revisions: Mapping[str, int] | None = None,
    ) -> dict[str, GainsChange]:
        """Change the parameters of several controllers between the same two cycles.

        Args:
            changes: New values by controller and name; other values stay.
            revisions: Revisions that the caller has read, by controller; a controller
                that is not named may have any.

        Returns:
            The changes, by controller.

        Raises:
            ControllerNotFoundError: A controller is not loaded; nothing changed.
            GainsChangedError: A revision is not the present one; nothing changed.
            InvalidGainError: A name or value is not allowed; nothing changed.
            LoopError: The loop died or hangs.
        """
        with self._change_lock:
            for name, revision in (revisions or {}).items():
                self._check_revision(name, revision)
            return self._apply(changes)

    def _check_revision(self, name: str, revision: int) -> None:
        """Refuse a revision that is not the present one; the caller has the lock.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
            GainsChangedError: The gains have another revision now.
        """
        self._manager.get_controller(name)
        # Look the name up first: an unknown controller would be at revision 0, too.
        present = self._revisions.get(name, 0)
        if revision != present:
            raise GainsChangedError(
                f"The gains of '{name}' changed since revision {revision}; they "
                f"are at {present}.",
                remedy="Read them again and repeat the change.",
                details={"revision": present},
            )

    @property
    def undoable_changes(self) -> int:
        """Number of changes that can be taken back."""
        return len(self._history)

    def undo(self) -> dict[str, GainsChange]:
        """Take back the last change that is still in force; return the new values.

        Raises:
            NothingToUndoError: There is no such change, or one of its controllers was
                unloaded since.
            LoopError: The loop died or hangs.
        """
        with self._change_lock:
            if not self._history:
                raise NothingToUndoError(
                    "No change of gains is left to be taken back.",
                    remedy="Set the gains, or apply a saved set.",
                )
            done = self._history.pop()
            loaded = {s.name for s in self._manager.controller_statistics()}
            for name, tunables in done.tunables.items():
                if (
                    name not in loaded
                    or self._manager.get_controller(name).tunables is not tunables
                ):
                    raise NothingToUndoError(
                        f"The last change was one of controller '{name}', which was "
                        "unloaded since; the change was dropped.",
                        remedy="Undo once more for the change before.",
                        details={"controller": name},
                    )
            return self._apply(done.previous, remember=False)

    def _apply(
        self, changes: Mapping[str, Mapping[str, float]], *, remember: bool = True
    ) -> dict[str, GainsChange]:
        found = {name: self._manager.get_controller(name).tunables for name in changes}
        before = {name: tunables.values for name, tunables in found.items()}
        # Check all of them before the first one changes.
        wanted = {name: found[name].checked(changes[name]) for name in changes}

        def apply() -> int:
            for name, values in wanted.items():
                found[name].apply(values)
            self._inputs.note_in_cycle("gains", changes=wanted)
            return self._loop.cycle

        cycle = self._loop.run_in_cycle(apply)
        if remember and found:
            previous = {
                name: {key: before[name][key] for key in changes[name]}
                for name in changes
            }
            self._history.append(_Done(found, previous))
        done = {}
        for name in changes:
            self.begin_revision(name)
            revision = self._revisions[name]
            notes = tuple(found[name].notes(wanted[name]))
            done[name] = GainsChange(wanted[name], before[name], revision, cycle, notes)
        return done
