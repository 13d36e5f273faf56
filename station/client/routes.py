"""How paths of the API are written, and names of what some of them take."""

from typing import Final, Literal
from urllib.parse import quote

PREFIX: Final = "/api/v1"
Strictness = Literal["strict", "best_effort"]
Restart = Literal["none", "previous"]


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
