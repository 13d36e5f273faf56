"""The inputs of a station since its first cycle, as a recording keeps them."""

import json
from collections.abc import Callable, Iterable, Mapping

from station.core.facade.input_log import Input, InputLog

MOST_INPUTS = 100_000
"""Most inputs since the station's start that a recording can have."""
_MOST_PENDING = 100


class RecordedInputs:
    """Keeps the inputs of a station as texts, each as soon as its cycle is known.

    Args:
        inputs: The station's record of its inputs.
        write: Called with each new text.

    Attributes:
        texts: The inputs so far, JSON.
        is_whole: Whether these are all inputs since the station's first cycle.
    """

    def __init__(self, inputs: InputLog, write: Callable[[str], None]) -> None:
        self.texts: list[str] = []
        self.is_whole = inputs.is_complete
        self._log = inputs
        self._write = write
        self._pending: list[Input] = []
        self._in_force: dict[str, Input] = {}

    def take(self, cycle: int) -> None:
        """Write the inputs of the station whose cycles are known by now.

        Args:
            cycle: The last cycle that the recorder has read.
        """
        self._note_expiries(list(self._in_force))
        self._pending += self._log.take_inputs()
        left = []
        for one in self._pending:
            after = one.after()
            if after is None:
                left.append(one)
                continue
            self._add({"after": after, "kind": one.kind, **_plain(one.arguments)})
            if one.kind == "set_point":
                name = str(one.arguments["name"])
                self._note_expiries([name])
                self._in_force[name] = one
        if not self._log.is_complete:
            self.lose("inputs that came faster than they could be kept", cycle)
        # Set-points that newer ones have replaced never get a cycle, so bound their
        # number.
        self._pending = left[-_MOST_PENDING:]

    def note_periods(self, cycle: int, periods: int) -> None:
        """Note a late cycle, which a re-run repeats, or a cycle that it cannot repeat.

        Args:
            cycle: Its number.
            periods: How many nominal periods have passed since the cycle before.
        """
        if periods == 1:
            return
        if periods:
            self._add({"after": cycle - 1, "kind": "late", "periods": periods})
        else:
            what = "a cycle while time stood still"
            self._add({"after": cycle - 1, "kind": "operation", "what": what})

    def lose(self, what: str, cycle: int) -> None:
        """Note once that the inputs are incomplete.

        Args:
            what: What is unknown, for the message.
            cycle: The last cycle that the recorder has read.
        """
        if self.is_whole:
            self.is_whole = False
            lost = {"after": cycle, "kind": "operation", "what": what}
            self._write(json.dumps(lost))

    def _add(self, values: dict[str, object]) -> None:
        text = json.dumps(values)
        if len(self.texts) < MOST_INPUTS:
            self.texts.append(text)
        else:
            self.lose(f"more than {MOST_INPUTS} inputs", int(str(values["after"])))
        self._write(text)

    def _note_expiries(self, names: Iterable[str]) -> None:
        """Note the controllers in `names` whose set-point has expired."""
        for name in names:
            one = self._in_force.get(name)
            until = None if one is None else one.until()
            if until is not None:
                del self._in_force[name]
                self._add({"after": until, "kind": "expire", "name": name})


def _plain(arguments: Mapping[str, object]) -> dict[str, object]:
    """Return arguments with only the types that JSON has; other values become text."""
    plain: dict[str, object] = json.loads(json.dumps(arguments, default=str))
    return plain
