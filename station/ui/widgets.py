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


class FollowingSlider:
    """A slider that shows a value of the station until a person moves it.

    A change in a browser arrives in another thread than the updates of the display. The
    value that a person set is therefore kept until the callback has used that value and
    called `taken`.

    Args:
        slider: The slider.
    """

    def __init__(self, slider: viser.GuiSliderHandle[float]) -> None:
        self.slider = slider
        self._shown = slider.value

    def is_moved(self) -> bool:
        """Return whether a person set a value that no callback has used yet."""
        return self.slider.value != self._shown

    def show(self, value: float) -> None:
        """Show `value`, unless a person moved the slider."""
        if not self.is_moved() and value != self._shown:
            self._shown = value
            set_value(self.slider, value)

    def taken(self) -> None:
        """Note that the value set by a person was used; follow the station again."""
        self._shown = self.slider.value


def set_options(dropdown: viser.GuiDropdownHandle[str], names: tuple[str, ...]) -> None:
    """Offer these names; the chosen name stays chosen while it is offered."""
    options = names or (NONE,)
    if tuple(dropdown.options) != options:
        dropdown.options = options
    dropdown.disabled = not names
