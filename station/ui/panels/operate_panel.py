"""The Operate tab: a slider per joint that commands the running group controller."""

import asyncio
from functools import partial
from typing import Any

import viser
from typing_extensions import override

from station.ui.markup import good, hint, warning
from station.ui.operate_model import (
    Movers,
    Operated,
    SetPointRamp,
    choose_operated,
)
from station.ui.panels.commanding_panel import CommandingPanel
from station.ui.reporter import Event, Reporter
from station.ui.slider_scale import SliderScale, command_scale
from station.ui.station_link import StationLink
from station.ui.station_view import Limits, StationView
from station.ui.widgets import FollowingSlider
from station.wire import CommandElement

_SEND_PERIOD = 0.04


class OperatePanel(CommandingPanel):
    """Sliders that follow the robot until a person moves one of them.

    Args:
        gui: Where the tab is built.
        link: The station.
        reporter: Says what went wrong.
        limits: Position limits of the robot's joints, for disabled sliders that only
            show the robot; limits that the station reports take precedence.

    Attributes:
        movers: Shared by all that command joints.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter, limits: Limits
    ) -> None:
        super().__init__(link, reporter)
        self._gui = gui
        self._limits = limits
        self.movers = Movers()
        self._ramp = SetPointRamp((), self.movers)
        self._state = gui.add_html(hint("Waiting for the station …"))
        self._speed = gui.add_slider(
            "Top speed [rad/s]", min=0.05, max=1.5, step=0.05, initial_value=0.5
        )
        self._folder = gui.add_folder("Joints")
        self._sliders: list[FollowingSlider] = []
        self._scales: list[SliderScale] = []
        self._shown: tuple[CommandElement, ...] = ()

    @override
    def let_go(self) -> None:
        self._ramp.let_go()

    @override
    def refresh(self, view: StationView) -> None:
        """Follow the robot, or show why the sliders are disabled."""
        operated = choose_operated(view)
        if operated.elements != self._operated.elements:
            self._ramp = SetPointRamp(operated.elements, self.movers)
        self._operate(operated, view)
        elements = operated.elements or _joint_elements(view, self._limits)
        if elements != self._shown:
            self._build(elements)
        self._follow(view)
        self._show(view)

    async def run(self) -> None:
        """Send set-points that approach the values of the sliders, until cancelled."""
        while True:
            await asyncio.sleep(_SEND_PERIOD)
            lost = [self._shown[i].name for i in self._ramp.give_up_lost()]
            if lost:
                text = f"Somebody else moves {', '.join(lost)} now."
                self._reporter.say("Motion ended", text, None)
            command = self._ramp.step(_SEND_PERIOD, self._speed.value)
            if command is None:
                continue
            with self._letting_go_when_refused():
                await self._link.client.command(
                    self._operated.name, command, epoch=self._epoch
                )
                self._ramp.confirm()

    def _follow(self, view: StationView) -> None:
        sample = view.samples.get(self._operated.name)
        if sample is None or len(sample.desired) != len(self._operated.elements):
            return
        desired = [value for value in sample.desired if value is not None]
        if len(desired) == len(sample.desired):
            self._ramp.follow(desired)

    def _show(self, view: StationView) -> None:
        reason = self._operated.reason
        for i, slider in enumerate(self._sliders):
            slider.slider.disabled = bool(reason)
            if self._operated.name and not reason:
                value = self._ramp.shown(i, view.now)
            else:
                value = view.positions.get(self._shown[i].name)
            if value is not None:
                slider.show(round(self._scales[i].clamp(value), 3))
        self._state.content = _state_markup(self._operated, self._ramp)

    def _build(self, elements: tuple[CommandElement, ...]) -> None:
        for old in self._sliders:
            old.slider.remove()
        self._sliders, self._scales = [], []
        self._shown = elements
        with self._folder:
            for i, element in enumerate(elements):
                scale = command_scale(element.unit, element.minimum, element.maximum)
                slider = self._gui.add_slider(
                    f"{_short_name(element.name, elements)} [{element.unit}]",
                    min=scale.minimum,
                    max=scale.maximum,
                    step=scale.step,
                    initial_value=scale.clamp(0.0),
                    disabled=True,
                    hint=f"{element.name}: {scale.minimum:g} to {scale.maximum:g} "
                    f"{element.unit}",
                )
                slider.on_update(self._reporter.guarded(partial(self._on_touch, i)))
                self._sliders.append(FollowingSlider(slider))
                self._scales.append(scale)

    async def _on_touch(self, index: int, event: Event[Any]) -> None:
        value = event.target.value
        self._sliders[index].taken()
        if self._operated.reason or not self._operated.name:
            # Viser does not enforce `disabled`, so a disabled slider can be moved.
            self._reporter.say("Not sent", self._operated.reason, event.client)
        elif not self._ramp.touch(index, value, self._link.now()):
            text = "It is not known yet where the robot was told to be. Try again."
            self._reporter.say("Not sent", text, event.client)


def _joint_elements(view: StationView, limits: Limits) -> tuple[CommandElement, ...]:
    """Return elements for sliders that only show the positions of the joints."""
    elements = []
    known = {**limits, **view.limits}
    for name in view.positions:
        if name in known:
            low, high = known[name]
            unit = "m" if "finger" in name else "rad"
            elements.append(
                CommandElement(name=name, unit=unit, minimum=low, maximum=high)
            )
    return tuple(elements)


def _short_name(name: str, elements: tuple[CommandElement, ...]) -> str:
    """Return a name without the prefix of all elements, e.g. `joint1`."""
    prefix = name.partition("_")[0] + "_"
    shared = all(element.name.startswith(prefix) for element in elements)
    return name.removeprefix(prefix) if shared and len(elements) > 1 else name


def _state_markup(operated: Operated, ramp: SetPointRamp) -> str:
    if operated.reason:
        return warning(operated.reason)
    if ramp.commanding:
        return good(f"Moving {operated.name}: {ramp.remaining:.2f} rad to go.")
    return good(f"Sliders command {operated.name} and follow it until you touch one.")
