"""The commands of one controller: checked after each of its calls, rested, compared."""

from station.core.control.command_gate import make_blocks
from station.core.control.command_guard import CommandGuard


class ControllerCommands:
    """Every command that a controller has claimed. Control thread only.

    Args:
        guards: One per claimed resource that takes commands.

    Attributes:
        guards: As given.
        slots: Slots of the commands.
        blocks: The commands as a few blocks; each keeps a copy of the commands that
            `refused` accepted last.
        is_shared: Whether the robot lets another running controller command one of the
            same resources; the later writer decides.
    """

    def __init__(self, guards: list[CommandGuard]) -> None:
        self.guards = guards
        self.slots = [slot for guard in guards for slot in guard.slots]
        self.is_shared = False
        self.blocks = make_blocks(self.slots)

    def refused(self) -> str | None:
        """Return the command that is not a real finite number; None if all are.

        Called after every call of the controller, so that a bad value is charged to
        the call that wrote it. Real numbers of other types become floats.
        """
        for block in self.blocks:
            if not block.copy_commands():
                # The quick check fails for NumPy's numbers, too. `_find_refused`
                # converts them, and names the first command that is no real number.
                refused = self._find_refused()
                if refused is not None:
                    return refused
                block.copy_commands()
        return None

    def is_as_written(self) -> bool:
        """Return whether the commands are still those of the last `refused`."""
        # Shared commands may be written by the other owner at any time.
        return self.is_shared or not any(block.has_changed() for block in self.blocks)

    def write_again(self) -> None:
        """Write the commands that `refused` accepted last."""
        for block in self.blocks:
            block.write_copy()

    def values(self) -> list[float]:
        """Return the present commands, in the order of `slots`."""
        return [storage[index] for storage, index in self.slots]

    def put_back(self, values: list[float]) -> str | None:
        """Undo the writes of a call; return the command that it changed.

        Args:
            values: Commands before the call, from `values`.

        Returns:
            The first resource that was changed and its new command; None if the call
            wrote nothing.
        """
        changed: str | None = None
        before = iter(values)
        for guard in self.guards:
            for storage, index in guard.slots:
                value, now = next(before), storage[index]
                # By identity first: a NaN that was there does not equal itself. By
                # type, because 0j equals 0.0 and an array has no single answer.
                if now is value or (type(now) is float and now == value):
                    continue
                changed = changed or guard.describe(now)
                storage[index] = value
        return changed

    def write_rest(self) -> None:
        """Command everything that is claimed to rest where it is."""
        for guard in self.guards:
            guard.write_rest()

    def put_back_claims(self, claims: set[tuple[str, str]]) -> None:
        """Write the commands that some claimed resources had before the start.

        Args:
            claims: (hardware interface, resource) of each claim.
        """
        for guard in self.guards:
            if guard.claim in claims:
                guard.write_last()

    def prepare(self, taken_over: set[tuple[str, str]]) -> str | None:
        """Make the commands ready for a start; return why that is impossible.

        Commands that are taken over continue; all others begin at rest, so that no old
        command reaches the robot.

        Args:
            taken_over: (hardware interface, resource) of claims that continue the last
                command.
        """
        for guard in self.guards:
            # A command taken over from a stopped controller continues, so that the
            # change is smooth.
            if guard.claim not in taken_over or guard.refused_command() is not None:
                guard.write_rest()
            if not guard.remember():
                return f"the state of '{guard.name}' is not finite"
        return None

    def jumps(self) -> dict[str, float]:
        """Return the largest jump of a command, by resource; see `CommandGuard`."""
        return {guard.name: guard.jump() for guard in self.guards}

    def excessive_jump(self) -> str | None:
        """Return a command that jumps too far, in words; None if none does."""
        for guard in self.guards:
            step, limit = guard.excess()
            if step > 0.0:
                return (
                    f"its first command for '{guard.name}' jumps by {step:.6g}; at "
                    f"most {limit:.6g} is allowed"
                )
        return None

    def _find_refused(self) -> str | None:
        for guard in self.guards:
            value = guard.refused_command()
            if value is not None:
                return f"command {value} for '{guard.name}'"
        return None
