"""How paths of the API are written, and names of what some of them take."""

from collections.abc import Mapping, Sequence
from typing import Final, Literal
from urllib.parse import quote

from pydantic import JsonValue

from station.wire import LoadRequest

PREFIX: Final = "/api/v1"
LEASE_HEADER: Final = "X-Control-Lease"
KEY_HEADER: Final = "Idempotency-Key"
Strictness = Literal["strict", "best_effort"]
Restart = Literal["none", "previous"]


def keyed(key: str | None) -> dict[str, str]:
    """Return the header with the key of a request; none when there is no key."""
    return {} if key is None else {KEY_HEADER: key}


def segment(name: str) -> str:
    """Return `name` as one segment of a path."""
    return quote(name, safe="")


def controller_path(name: str, rest: str = "") -> str:
    """Return the path of a controller, or of a part of it.

    Args:
        name: The controller.
        rest: The part, without a slash at its beginning.
    """
    path = f"/controllers/{segment(name)}"
    return f"{path}/{rest}" if rest else path


def goal_path(name: str, goal_id: str) -> str:
    """Return the path of a controller's goal."""
    return f"{controller_path(name, 'goals')}/{segment(goal_id)}"


def event_query(
    since: int | None, kinds: Sequence[str], severity: str, limit: int
) -> dict[str, str | list[str]]:
    """Return the query that asks for events.

    Args:
        since: Number of the last event that is known; the newest events when None.
        kinds: Only events of these kinds; all when empty.
        severity: Only events of at least this severity.
        limit: Most events.
    """
    known = {} if since is None else {"since": str(since)}
    return {"severity": severity, "limit": str(limit), "kind": list(kinds), **known}


def load_request(
    name: str,
    type: str | None,  # noqa: A002 - ros_control's word
    params: Mapping[str, JsonValue] | None,
    timeout: float | None,
    unknown_params: str | None,
) -> LoadRequest:
    """Return the request that loads a controller; what is None is left out.

    Args:
        name: Its name.
        type: Its plugin type.
        params: Its parameters.
        timeout: How long its import, constructor and init may take [s].
        unknown_params: `refuse` or `tell`.
    """
    given = {
        "name": name,
        "type": type,
        "params": params,
        "timeout": timeout,
        "unknown_params": unknown_params,
    }
    return LoadRequest.model_validate({
        key: value for key, value in given.items() if value is not None
    })
