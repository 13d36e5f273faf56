"""Set Viser's widgets from the dashboard's side."""

from typing import TypeVar

import viser

NONE = "(none)"
"""What a dropdown offers when there is nothing to choose."""

_Value = TypeVar("_Value", float, str, bool)


def set_value(widget: viser.GuiInputHandle[_Value], value: _Value) -> None:
    """Set what an input shows, in all browsers."""
    # Viser's setter is real, but mypy does not see it: a method stands in between.
    widget.value = value  # type: ignore[misc]


def set_options(dropdown: viser.GuiDropdownHandle[str], names: tuple[str, ...]) -> None:
    """Offer these names; keep the chosen one while it is among them."""
    options = names or (NONE,)
    if tuple(dropdown.options) != options:
        dropdown.options = options
    dropdown.disabled = not names
