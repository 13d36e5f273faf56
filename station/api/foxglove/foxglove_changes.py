"""Changes by a Foxglove client: of gains (as parameters) and running controllers."""

import json
from dataclasses import dataclass
from sys import float_info
from typing import TypeGuard

from station.api.tool_port import ToolClient, reason_of
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    InvalidCommandError,
    InvalidGainError,
    StationError,
    suggest,
)

SWITCH_SERVICE = "/switch_controllers"
_SLASH = "/"


@dataclass(frozen=True, slots=True)
class GainsAnswer:
    """The result of a client's change of parameters.

    Attributes:
        values: Present values of the requested gains that exist.
        problems: Reasons for which gains were not set, one sentence each.
    """

    values: dict[str, float]
    problems: list[str]


class FoxgloveChanges:
    """The changes of one client. Its methods may block, so call them in worker threads.

    Args:
        client: The client, with its rights.
    """

    def __init__(self, client: ToolClient) -> None:
        self._client = client
        self._station = client.services.station

    def gains(self, names: list[str]) -> dict[str, float]:
        """Return gains by `controller/gain`; all if `names` is empty."""
        found = {
            f"{controller}{_SLASH}{name}": value
            for controller, values in self._station.tuning.all_gains().items()
            for name, value in values.items()
        }
        return {name: found[name] for name in names or found if name in found}

    def set_gains(self, wanted: dict[str, object]) -> GainsAnswer:
        """Set gains; valid values are set even if others are refused.

        Args:
            wanted: Values by `controller/gain`.
        """
        what = f"setParameters {', '.join(wanted)}"
        try:
            self._client.check(what)
        except StationError as error:
            return GainsAnswer(self.gains(list(wanted)), [reason_of(error)])
        problems: list[str] = []
        known, good = self.gains([]), {}
        for name, value in wanted.items():
            if name not in known:
                problems.append(f"There is no gain '{name}'. {suggest(name, known)}")
            elif not _is_double(value):
                problems.append(f"The gain '{name}' cannot be {value!r:.40}.")
            else:
                good[name] = float(value)
        problems += self._set(good)
        result = "done" if not problems else "refused: " + " ".join(problems)
        self._client.record(what, result, is_done=not problems)
        return GainsAnswer(self.gains(list(wanted)), problems)

    def switch(self, payload: bytes) -> bytes:
        """Start and stop controllers; return the answer as JSON.

        Args:
            payload: JSON with lists of names, `start` and `stop`.

        Raises:
            StationError: The change is refused.
            InvalidCommandError: The switch failed; the same controllers run as before.
            ValueError: The payload is not JSON.
            RecursionError: The payload is too deeply nested.
        """
        self._client.check(SWITCH_SERVICE)
        try:
            asked = json.loads(payload)
            start, stop = _names(asked, "start"), _names(asked, "stop")
            result = self._station.switch_controllers(SwitchRequest(start, stop))
        except (StationError, ValueError, RecursionError) as error:
            self._client.record(SWITCH_SERVICE, f"refused: {error}", is_done=False)
            raise
        self._client.services.event_recorder.switch(self._client.websocket, result)
        ended = "done" if result.ok else "failed"
        self._client.record(SWITCH_SERVICE, ended, is_done=result.ok)
        if not result.ok:
            failed = (f"{name}: {why}" for name, why in result.failed.items())
            raise InvalidCommandError(
                f"The switch was {result.outcome.name.lower()}. {' '.join(failed)}"
            )
        return json.dumps({"ok": True, "message": ""}).encode()

    def _set(self, good: dict[str, float]) -> list[str]:
        """Set gains that exist; return the reasons for those that could not be set."""
        if not good:
            return []
        try:
            self._station.tuning.set_many(_by_controller(good))
        except InvalidGainError as error:
            if len(good) == 1:
                return [reason_of(error)]
            # Set them one by one, so that a wrong value does not keep the others from
            # being set.
            return [
                one for name, value in good.items() for one in self._set({name: value})
            ]
        except StationError as error:
            return [reason_of(error)]
        return []


def _by_controller(gains: dict[str, float]) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for name, value in gains.items():
        controller, _, gain = name.partition(_SLASH)
        found.setdefault(controller, {})[gain] = value
    return found


def _names(asked: object, key: str) -> list[str]:
    """Return a list of names of a request.

    Raises:
        InvalidCommandError: The names are not a list of strings.
    """
    names = asked.get(key, []) if isinstance(asked, dict) else None
    if isinstance(names, list) and all(isinstance(one, str) for one in names):
        return names
    raise InvalidCommandError(
        f"'{key}' is no list of names of controllers.",
        remedy='Send {"start": ["arm"], "stop": []}.',
    )


def _is_double(value: object) -> TypeGuard[float]:
    """Return whether JSON has a number here, and not one beyond all doubles."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return not isinstance(value, int) or abs(value) <= float_info.max
