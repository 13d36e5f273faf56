"""The page of memory that a control loop shares with a watchdog in another process.

The loop stores the time of every wake-up and reads one byte per cycle. Nothing here
takes a lock, so neither side can make the other one wait, and the page remains readable
when the interpreter of the station no longer runs.

The watchdog, whose process must stay small, imports this module: it uses only a few
modules of the standard library.
"""

import mmap
from enum import IntEnum

PAGE_BYTES = mmap.PAGESIZE
"""Size of the shared memory [bytes]."""
_REASON_AT = 64
_REASON_BYTES = 512


class Phase(IntEnum):
    """The station's phase, as its main thread reports it to the watchdog."""

    STARTING = 0
    """Parts are being built: imports hold the interpreter, and cycles may be late."""
    RUNNING = 1
    """The station is in service: a loop that does not wake up is a fault."""
    ENDING = 2
    """The station shuts its parts down in order."""


class LoopLife(IntEnum):
    """The state of the control thread, which it writes itself for the watchdog."""

    STOPPED = 0
    """There is no control thread."""
    RUNNING = 1
    """The thread wakes up in every period, or more often, paused or not."""
    DIED = 2
    """An exception ended the thread."""


class Heartbeat:
    """The shared page: two times, four bytes, and the reason of a stop.

    Args:
        memory: At least `PAGE_BYTES` writable bytes. Without a watchdog, a page of this
            process is used, so that the loop has only one code path.

    Attributes:
        beats: One number, the monotonic time of the loop's last wake-up [s]. Storing it
            is the only thing that a cycle does for the watchdog.
        watchdog_beats: One number, the monotonic time of the watchdog's last look [s];
            0 until a watchdog is started.
        flags: Four bytes; `flags[0]` is 1 while a stop asked for by the watchdog waits
            for the loop. The others are read and written by the properties.
    """

    STOP = 0
    _LIFE = 1
    _PHASE = 2
    _ENDED = 3

    def __init__(self, memory: mmap.mmap | bytearray | None = None) -> None:
        # Without shared memory there is no watchdog, but the loop writes its beats.
        view = memoryview(bytearray(PAGE_BYTES) if memory is None else memory)
        # Eight bytes at a multiple of eight are written at once, so another process
        # never reads half a time.
        self.beats = view[0:8].cast("d")
        self.flags = view[8:12]
        self.watchdog_beats = view[16:24].cast("d")
        self._reason = view[_REASON_AT : _REASON_AT + _REASON_BYTES]

    @property
    def life(self) -> LoopLife:
        """Return the state of the control thread."""
        return LoopLife(self.flags[self._LIFE])

    @life.setter
    def life(self, life: LoopLife) -> None:
        self.flags[self._LIFE] = life

    @property
    def phase(self) -> Phase:
        """Return the phase of the station."""
        return Phase(self.flags[self._PHASE])

    @phase.setter
    def phase(self, phase: Phase) -> None:
        self.flags[self._PHASE] = phase

    @property
    def is_ended_by_watchdog(self) -> bool:
        """Return whether the watchdog has asked the station to end."""
        return bool(self.flags[self._ENDED])

    def note_end_by_watchdog(self) -> None:
        """Record that the watchdog ends the station; the watchdog's side."""
        self.flags[self._ENDED] = 1

    @property
    def is_stop_asked(self) -> bool:
        """Return whether a stop of the watchdog waits for the loop."""
        return bool(self.flags[self.STOP])

    def ask_stop(self, reason: str) -> None:
        """Latch a stop for the loop; the watchdog's side.

        Args:
            reason: Why, for people; at most 511 bytes of UTF-8 are kept.
        """
        # One byte stays zero, as the end of the text.
        text = reason.encode()[: _REASON_BYTES - 1]
        # The flag comes last: the loop reads the reason once it sees the flag.
        self._reason[:] = text.ljust(_REASON_BYTES, b"\0")
        self.flags[self.STOP] = 1

    def stop_reason(self) -> str:
        """Return the watchdog's reason for its last stop."""
        return bytes(self._reason).rstrip(b"\0").decode(errors="replace")

    def confirm_stop(self) -> None:
        """Tell the watchdog that the loop has carried out its stop."""
        self.flags[self.STOP] = 0
