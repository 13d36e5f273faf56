"""What schemathesis must do for the whole API to be in reach of a run."""

from typing import Any

import schemathesis

SHORT = 0.5
"""Longest lease of control [s]: while one lasts, all other requests are refused."""


@schemathesis.hook
def before_call(
    _context: schemathesis.HookContext,
    case: schemathesis.Case,
    _kwargs: dict[str, Any],
) -> None:
    """Shorten leases of control, where the request is sound otherwise."""
    if case.path != "/api/v1/control" or case.method not in {"POST", "PATCH"}:
        return
    if case.body is None or not isinstance(case.body, dict):
        return
    ttl = case.body.get("ttl", 10.0)
    if isinstance(ttl, (int, float)) and not isinstance(ttl, bool) and ttl > SHORT:
        case.body["ttl"] = SHORT
