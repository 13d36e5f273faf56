"""The Tune tab: the gains of a joint, and a live plot of the joint's response."""

import asyncio
from functools import partial
from typing import Any

import viser
from typing_extensions import override

from station.client import ApiError
from station.ui.markup import hint, warning
from station.ui.panels.panel import Panel
from station.ui.panels.response_plot import ResponsePlot
from station.ui.reporter import Event, Reporter
from station.ui.slider_scale import gain_scale
from station.ui.station_link import StationLink
from station.ui.station_view import StationView
from station.ui.tune_model import (
    gain_groups,
    gain_label,
    series_index,
    tunable_controllers,
)
from station.ui.widgets import NONE, FollowingSlider, set_options, set_value
from station.wire import Gains

_GAINS_PERIOD = 1.0
_SETTLE = 0.12
_FOLLOW_AGAIN = 1.5


class TunePanel(Panel):
    """Gains and plot of one joint of one controller.

    Args:
        gui: Where the tab is built.
        link: The station.
        reporter: Says what went wrong.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        self._gui = gui
        super().__init__(link, reporter)
        self._gains: Gains | None = None
        self._gains_of = ""
        self._chosen = gui.add_dropdown("Controller", (NONE,), disabled=True)
        self._chosen_by_hand = False
        self._chosen.on_update(reporter.guarded(self._on_choice))
        self._group = gui.add_dropdown("Joint", (NONE,), disabled=True)
        self._plot = ResponsePlot(gui)
        self._folder = gui.add_folder("Gains")
        with self._folder:
            self._note = gui.add_html(hint("Waiting for the station …"))
        self._sliders: dict[str, FollowingSlider] = {}
        self._built_for: tuple[str, str] = ("", "")
        self._touched_at = float("-inf")
        self._pending: dict[str, float] = {}

    @override
    def watched(self) -> set[str]:
        """Return the controller in the plot."""
        return set() if self._chosen.value == NONE else {self._chosen.value}

    @override
    def refresh(self, view: StationView) -> None:
        """Show gains and plot of the chosen joint."""
        tunable = tunable_controllers(view)
        set_options(self._chosen, tuple(tunable))
        if tunable and not self._chosen_by_hand:
            set_value(self._chosen, tunable[0])
        name = self._chosen.value
        history = self._link.histories.get(name)
        own_gains = self._gains if self._gains_of == name else None
        groups = gain_groups(own_gains.values) if own_gains else {}
        sample = view.samples.get(name)
        joints = tuple(groups) or tuple(sample.name if sample else ())
        if joints:  # Else keep the choice until they are known again.
            set_options(self._group, joints)
        group = self._group.value
        if own_gains is not None:
            self._show_gains(own_gains, groups.get(group, []), view)
        else:
            self._clear()
        self._note.content = self._note_markup(view, own_gains)
        if history is not None and history.names:
            index = series_index(history.names, group)
            self._plot.show(history, index or 0, _unit(view, name, group))

    async def run(self) -> None:
        """Ask for the gains of the chosen controller, until cancelled."""
        while True:
            await self._read_gains(self._chosen.value)
            await asyncio.sleep(_GAINS_PERIOD)

    async def _read_gains(self, name: str) -> None:
        if name == NONE:
            self._gains = None
            return
        try:
            self._gains = await self._link.client.gains(name)
        except ApiError:
            self._gains = None  # No gains, or no such controller; the note says so.
        self._gains_of = name

    def _show_gains(self, gains: Gains, names: list[str], view: StationView) -> None:
        key = (self._gains_of, ",".join(names))
        if key != self._built_for:
            self._clear()
            self._build(gains, names)
            self._built_for = key
        blocked = view.link != "live"
        following = view.now - self._touched_at > _FOLLOW_AGAIN
        for name, slider in self._sliders.items():
            slider.slider.disabled = blocked
            if following:
                self._rescale(slider, gains, name)

    def _rescale(self, following: FollowingSlider, gains: Gains, name: str) -> None:
        value, slider = gains.values[name], following.slider
        if slider.value == value or following.is_moved():
            return
        allowed = gains.tunables[name]
        scale = gain_scale(value, allowed.minimum, allowed.maximum)
        slider.min, slider.max = min(slider.min, scale.minimum), scale.maximum
        slider.step = scale.step
        following.show(value)

    def _build(self, gains: Gains, names: list[str]) -> None:
        with self._folder:
            for name in names:
                allowed = gains.tunables[name]
                value = gains.values[name]
                scale = gain_scale(value, allowed.minimum, allowed.maximum)
                slider = self._gui.add_slider(
                    gain_label(name, allowed.unit),
                    min=scale.minimum,
                    max=scale.maximum,
                    step=scale.step,
                    initial_value=scale.clamp(value),
                    hint=_allowed_text(allowed.description, name, gains),
                )
                slider.on_update(self._reporter.guarded(partial(self._on_gain, name)))
                self._sliders[name] = FollowingSlider(slider)

    def _clear(self) -> None:
        for old in self._sliders.values():
            old.slider.remove()
        self._sliders.clear()
        self._built_for = ("", "")

    async def _on_choice(self, _event: Event[Any]) -> None:
        self._chosen_by_hand = True

    async def _on_gain(self, name: str, event: Event[Any]) -> None:
        """Send a gain once the slider has rested for a moment."""
        self._touched_at = self._link.now()
        controller = self._gains_of
        value = float(event.target.value)
        if name in self._sliders:
            self._sliders[name].taken()
        self._pending[name] = value
        await asyncio.sleep(_SETTLE)
        if self._pending.get(name) != value:
            return
        del self._pending[name]
        try:
            await self._link.client.set_gains(controller, {name: value})
        finally:
            await self._read_gains(controller)

    def _note_markup(self, view: StationView, gains: Gains | None) -> str:
        if view.link != "live":
            return warning(view.blocked())
        if self._chosen.value == NONE:
            return hint("No controller that commands joints is loaded.")
        if gains is None or not gains.values:
            return hint(f"{self._chosen.value} has no gains to tune.")
        return hint("A change takes effect at once, in one cycle.")


def _unit(view: StationView, controller: str, group: str) -> str:
    for element in view.elements.get(controller, ()):
        if element.name == group:
            return element.unit
    return ""


def _allowed_text(description: str, name: str, gains: Gains) -> str:
    allowed = gains.tunables[name]
    low = "-∞" if allowed.minimum is None else f"{allowed.minimum:g}"
    high = "∞" if allowed.maximum is None else f"{allowed.maximum:g}"
    return f"{description} Allowed: {low} to {high} {allowed.unit}".strip()
