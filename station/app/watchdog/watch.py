"""The watchdog's actions: notice a standstill, report, hold, end the station."""

import json
import os
import signal
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

from station.core.loop.heartbeat import Heartbeat, LoopLife, Phase

NOTICE_AFTER = 0.08
"""Age of the loop's last wake-up that counts as a stall [s]. With `LOOK_PERIOD` between
looks, it is reported within 0.1 s."""
LOOK_PERIOD = 0.01
"""Time between two looks of the watchdog [s]."""


class WatchdogSettings(NamedTuple):
    """The process to watch, and the reaction to a standstill of its loop.

    Attributes:
        pid: Process number of the station.
        operator_token: Token with all rights here.
        viewer_token: Token with the rights to read and to stop.
        incident_directory: Folder of the incident files; made when needed.
        hold_commands: Command lines that make the drivers of real arms hold; each is
            started without a shell when the loop stalls, and must end within 1 s.
        stack_signal: Signal at which the station writes the stacks of its threads to a
            file, even while a thread holds the interpreter lock; 0 for none.
        notice_after: Age of the last wake-up that counts as a stall [s], > 0.
        end_after: Duration of a stall after which the watchdog ends the station [s];
            None never ends it.
    """

    pid: int
    operator_token: str
    viewer_token: str
    incident_directory: str
    hold_commands: tuple[tuple[str, ...], ...] = ()
    stack_signal: int = 0
    notice_after: float = NOTICE_AFTER
    end_after: float | None = 10.0


STACKS_AFTER = 1.0
"""Duration of a stall after which the watchdog asks for the station's stacks [s].

Walking the stacks of running threads is risky, so it is not done for a short stall."""
WRITING_TIME = 0.3
"""Time for the station to write its stacks [s]."""
KILL_AFTER = 2.0
"""Time from SIGTERM to SIGKILL for a station that is being ended [s]."""
ENDING_TIME = 5.0
"""Longest orderly end of a station before it is killed [s]; a sound station needs less
than 3 s."""
SLOW_STEP = 3.0
"""Duration of a step of the start after which it is reported, and again at each
doubling [s]."""


class Watch:
    """Checks the heartbeat and reacts. Use it in one thread at a time; it never waits.

    Args:
        heartbeat: The page shared with the station.
        settings: Process to watch, and the limits.
        tell: Called with a line for the station's user.
        send: Sends the station a signal.
        forget_stacks: Deletes the stacks that the station wrote at earlier signals.
        read_stacks: Returns the stacks that the station wrote at `stack_signal`.
    """

    def __init__(
        self,
        heartbeat: Heartbeat,
        settings: WatchdogSettings,
        *,
        tell: Callable[[str], None],
        send: Callable[[int], None],
        forget_stacks: Callable[[], None] = lambda: None,
        read_stacks: Callable[[], str] = lambda: "",
    ) -> None:
        self.heartbeat = heartbeat
        self.settings = settings
        self.status: Mapping[str, object] = {}
        self.incident: Incident | None = None
        self._tell = tell
        self._send = send
        self._forget_stacks = forget_stacks
        self._read_stacks = read_stacks
        self._holds = HoldCommands(settings.hold_commands)
        self._trouble_since: float | None = None
        self._ended_at: float | None = None
        self._is_killed = False
        self._are_stacks_asked = self._are_stacks_read = False
        self._ending_since: float | None = None
        self._step: tuple[str, float, float] = ("", 0.0, SLOW_STEP)

    def age(self, now: float) -> float:
        """Return the time since the loop last woke up [s]."""
        return now - self.heartbeat.beats[0]

    def trouble(self, now: float) -> str | None:
        """Return the reason why the station is not ready; None if it is."""
        if self.heartbeat.phase is Phase.STARTING:
            step = self._step[0]
            return f"The station still starts{f': {step}' if step else ''}."
        if self.heartbeat.phase is Phase.ENDING:
            return "The station ends."
        if self.heartbeat.life is LoopLife.DIED:
            return "The control loop died."
        if self.heartbeat.life is LoopLife.STOPPED:
            return "The control loop is not running."
        if self.age(now) > self.settings.notice_after:
            return f"The control loop has stood still for {self.age(now):.2f} s."
        return None

    def look(self, now: float) -> None:
        """Check the heartbeat once, and react if a limit is exceeded.

        Args:
            now: Monotonic time [s].
        """
        if self._holds.look(now) and self.incident is not None:
            self.incident.add(hold_commands=self._holds.outcomes)
        phase = self.heartbeat.phase
        if phase is Phase.STARTING:
            self._look_at_start(now)
        elif phase is Phase.ENDING:
            self._look_at_end(now)
        else:
            self._look_at_loop(now)

    def take_settings(self, settings: WatchdogSettings) -> None:
        """Replace the settings, e.g. when the robot is built and has hold commands."""
        self.settings = settings
        self._holds.commands = settings.hold_commands

    def take_status(self, status: Mapping[str, object]) -> None:
        """Keep the last published state of the station."""
        self.status = status

    def hold(self, now: float) -> None:
        """Tell the drivers of real arms to hold."""
        self._holds.start(now)

    def _look_at_start(self, now: float) -> None:
        step = str(self.status.get("step", ""))
        known, since, limit = self._step
        if step != known:
            self._step = (step, now, SLOW_STEP)
        elif step and now - since > limit:
            self._tell(f"The station still starts: {step} ({now - since:.0f} s).")
            self._step = (step, since, 2.0 * limit)

    def _look_at_end(self, now: float) -> None:
        if self._ending_since is None:
            self._ending_since = now
        elif now - self._ending_since > ENDING_TIME and not self._is_killed:
            self._tell(
                f"The station has not ended within {ENDING_TIME:g} s; it is killed."
            )
            self._kill()
        self._kill_when_due(now)

    def _look_at_loop(self, now: float) -> None:
        trouble = self.trouble(now)
        if self._trouble_since is None:
            if trouble is not None:
                self._begin(trouble, now)
            return
        duration = now - self._trouble_since
        if trouble is None:
            self._recovered(duration)
        elif self.heartbeat.life is LoopLife.RUNNING:
            self._look_at_stall(now, duration)
        self._kill_when_due(now)

    def _begin(self, trouble: str, now: float) -> None:
        self._trouble_since = now
        self._are_stacks_asked = self._are_stacks_read = False
        if self.settings.hold_commands:
            # The arms hold by command of the watchdog, so a loop that recovers must
            # stop instead of continuing the motion.
            self.heartbeat.ask_stop(f"{trouble} The watchdog told the arms to hold.")
        self._holds.outcomes = []
        self.hold(now)
        self.incident = Incident(
            self.settings.incident_directory,
            self.settings.pid,
            {
                "what": trouble,
                "last_wake_up_age": round(self.age(now), 4),
                "last_published": dict(self.status),
                "hold_commands": self._holds.outcomes,
                "recovered_after": None,
                "ended_by": None,
                "stacks": None,
            },
        )
        running = self.status.get("running") or "none"
        where = self.incident.path
        if self.incident.failure is not None:
            where = f"{where} cannot be written: {self.incident.failure}"
        self._tell(
            f"{trouble} Running controllers, as told last: {running}. "
            f"Incident: {where}."
        )

    def _recovered(self, duration: float) -> None:
        self._trouble_since = None
        self._tell(f"The control loop runs again after {duration:.2f} s.")
        if self.incident is not None:
            self.incident.add(recovered_after=round(duration, 3))

    def _look_at_stall(self, now: float, duration: float) -> None:
        if duration > STACKS_AFTER and self.settings.stack_signal:
            self._collect_stacks(duration)
        end_after = self.settings.end_after
        if end_after is not None and duration > end_after and self._ended_at is None:
            self._tell(
                f"The control loop has not come back within {end_after:g} s: the "
                "watchdog ends the station."
            )
            self._ended_at = now
            self.heartbeat.note_end_by_watchdog()
            self._send(signal.SIGTERM)
            if self.incident is not None:
                self.incident.add(ended_by="SIGTERM")

    def _collect_stacks(self, duration: float) -> None:
        if not self._are_stacks_asked:
            self._are_stacks_asked = True
            self._forget_stacks()
            self._send(self.settings.stack_signal)
            return
        is_written = duration > STACKS_AFTER + WRITING_TIME
        if is_written and not self._are_stacks_read and self.incident is not None:
            self._are_stacks_read = True
            self.incident.add(stacks=self._read_stacks().splitlines())

    def _kill_when_due(self, now: float) -> None:
        if self._ended_at is None or self._is_killed:
            return
        if now - self._ended_at > KILL_AFTER:
            self._tell("The station does not end when asked to; it is killed.")
            self._kill()

    def _kill(self) -> None:
        self._is_killed = True
        if self.incident is not None:
            self.incident.add(ended_by="SIGKILL")
        self._send(signal.SIGKILL)


TIME_LIMIT = 1.0
"""Longest run of a hold command before it is killed [s]."""


class HoldCommands:
    """Starts the hold commands of all arms at the same time, and collects their ends.

    Args:
        commands: Command lines; they are started without a shell.

    Attributes:
        commands: As given; may be replaced.
        outcomes: How each started command has ended, oldest first.
    """

    def __init__(self, commands: tuple[tuple[str, ...], ...]) -> None:
        self.commands = commands
        self._running: dict[int, tuple[tuple[str, ...], float]] = {}
        self.outcomes: list[dict[str, object]] = []

    def start(self, now: float) -> None:
        """Start every command that is not running.

        Args:
            now: Monotonic time [s].
        """
        running = [command for command, _ in self._running.values()]
        for command in self.commands:
            if command in running:
                continue
            try:
                pid = os.posix_spawnp(command[0], command, os.environ)
            except OSError as error:
                self._note(command, f"could not be started: {error.strerror}")
            else:
                self._running[pid] = (command, now)

    def look(self, now: float) -> bool:
        """Collect the commands that have ended; kill those that run too long.

        Returns:
            Whether `outcomes` has changed.
        """
        before = len(self.outcomes)
        for pid, (command, began) in list(self._running.items()):
            ended, status = os.waitpid(pid, os.WNOHANG)
            if ended:
                del self._running[pid]
                code = os.waitstatus_to_exitcode(status)
                self._note(command, f"ended with exit code {code}")
            elif now - began > TIME_LIMIT:
                # The next look collects it as ended by SIGKILL.
                os.kill(pid, signal.SIGKILL)
        return len(self.outcomes) != before

    def _note(self, command: tuple[str, ...], outcome: str) -> None:
        self.outcomes.append({"command": list(command), "outcome": outcome})


KEPT = 100
"""Number of incident files that are kept; the oldest are deleted first."""


class Incident:
    """An incident, and its file, which is always replaced as a whole.

    Args:
        directory: Folder of the file.
        pid: Process number of the station.
        facts: Facts at the beginning; more are added with `add`.

    Attributes:
        path: The file.
        facts: All facts so far.
        failure: Why the file could not be written; None if it was written. It is no
            exception, because a full disk must not end the watchdog.
    """

    def __init__(self, directory: str, pid: int, facts: dict[str, object]) -> None:
        stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
        serial = time.monotonic_ns() // 1_000_000
        self.path = os.path.join(directory, f"{stamp}-{pid}-{serial}.json")
        self.facts = {"station_pid": pid, "began_at": stamp, **facts}
        self.failure: str | None = None
        self._directory = directory
        self._write()

    def add(self, **facts: object) -> None:
        """Add or replace facts, and write the file again."""
        self.facts.update(facts)
        self._write()

    def _write(self) -> None:
        try:
            if not os.path.exists(self.path):
                os.makedirs(self._directory, mode=0o700, exist_ok=True)
                _forget_oldest(self._directory)
            self._replace()
        except OSError as error:
            self.failure = error.strerror
        else:
            self.failure = None

    def _replace(self) -> None:
        draft = f"{self.path}.draft"
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW
        with os.fdopen(os.open(draft, flags, 0o600), "w", encoding="utf-8") as file:
            json.dump(self.facts, file, indent=1)
        os.replace(draft, self.path)


def _forget_oldest(directory: str) -> None:
    names = sorted(name for name in os.listdir(directory) if name.endswith(".json"))
    for name in names[: max(len(names) - KEPT + 1, 0)]:
        os.unlink(os.path.join(directory, name))
