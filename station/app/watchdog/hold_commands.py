"""Commands by which a real arm's driver is told to hold, when the station cannot."""

import os
import signal

TIME_LIMIT = 1.0
"""A hold command that runs longer is killed [s]."""


class HoldCommands:
    """Starts the hold commands of all arms at once and collects how they ended.

    Args:
        commands: Command lines; they are started without a shell.

    Attributes:
        commands: The same; they may be replaced.
        outcomes: How each command that was started has ended, oldest first.
    """

    def __init__(self, commands: tuple[tuple[str, ...], ...]) -> None:
        self.commands = commands
        self._running: dict[int, tuple[tuple[str, ...], float]] = {}
        self.outcomes: list[dict[str, object]] = []

    def start(self, now: float) -> None:
        """Start every command that does not run at the moment.

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
        """Collect the commands that have ended; kill those beyond their time.

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
                # It is collected as ended by SIGKILL the next time.
                os.kill(pid, signal.SIGKILL)
        return len(self.outcomes) != before

    def _note(self, command: tuple[str, ...], outcome: str) -> None:
        self.outcomes.append({"command": list(command), "outcome": outcome})
