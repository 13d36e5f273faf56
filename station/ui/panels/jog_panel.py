"""Buttons of the Operate tab that move the end effector while they are held."""

import asyncio
from functools import partial
from typing import Any

import viser
from typing_extensions import override

from station.client import ApiError
from station.ui.cartesian_model import TWIST, HeldButtons, choose_cartesian
from station.ui.markup import good, hint, warning
from station.ui.operate_model import Operated
from station.ui.panels.commanding_panel import CommandingPanel
from station.ui.reporter import Event, Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView
from station.ui.widgets import set_value

KIND = "CartesianJogController"
AXES = ("Base", "End effector")
"""Choices of the dropdown; the index is the controller's run-time parameter `frame`."""
HEARTBEAT_HZ = 20.0
_SEND_PERIOD = 0.04
_LABELS = ("x", "y", "z", "about x", "about y", "about z")
_COLOURS = ((201, 60, 60), (47, 140, 68), (34, 110, 196))
_SIGNS = ((1, "+"), (-1, "−"))  # noqa: RUF001 - a minus that is as wide as the plus


class JogPanel(CommandingPanel):
    """Twelve hold-to-run buttons.

    Args:
        gui: Where the folder is built.
        link: The station.
        reporter: Says what went wrong.
        arm: The arm whose end effector they move; empty where there are not several.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        link: StationLink,
        reporter: Reporter,
        arm: str = "",
    ) -> None:
        super().__init__(link, reporter)
        self._arm = arm
        self._buttons = HeldButtons()
        self._told = ""
        self._handles: list[viser.GuiButtonHandle] = []
        whose = f"End effector of {arm}" if arm else "End effector"
        with gui.add_folder(f"{whose}: hold to move"):
            self._state = gui.add_html(hint("Waiting for the station …"))
            self._axes = gui.add_dropdown(
                "Axes of", AXES, hint="In whose axes the end effector moves."
            )
            self._axes.on_update(reporter.guarded(self._on_axes))
            self._speed = gui.add_slider(
                "Speed [m/s]", min=0.01, max=0.3, step=0.01, initial_value=0.1
            )
            self._turn = gui.add_slider(
                "Turning speed [rad/s]", min=0.05, max=1.0, step=0.05, initial_value=0.4
            )
            for axis, label in enumerate(_LABELS):
                for sign, mark in _SIGNS:
                    button = gui.add_button(
                        f"{mark} {label}",
                        color=_COLOURS[axis % 3],
                        disabled=True,
                        hint="Moves while you hold it.",
                    )
                    held = partial(self._on_hold, axis, sign)
                    button.on_hold(reporter.guarded(held), callback_hz=HEARTBEAT_HZ)
                    # Viser reports a released button as a click.
                    button.on_click(
                        reporter.guarded(partial(self._on_release, axis, sign))
                    )
                    self._handles.append(button)

    @override
    def let_go(self) -> None:
        self._buttons.let_go()

    @override
    def refresh(self, view: StationView) -> None:
        """Show whether the buttons can be used; if they cannot, show why."""
        operated = choose_cartesian(view, TWIST, KIND, self._arm)
        if operated.elements and operated.elements != self._operated.elements:
            self._fit(operated)
        self._operate(operated, view)
        for widget in (*self._handles, self._axes):
            widget.disabled = bool(operated.reason)
        # Fourteen disabled widgets would hide the widgets that can be used.
        for widget in (*self._handles, self._axes, self._speed, self._turn):
            widget.visible = not operated.reason
        self._state.content = self._markup()

    async def run(self) -> None:
        """Send the twist of the held buttons, until cancelled."""
        asked_for = ""
        while True:
            await asyncio.sleep(_SEND_PERIOD)
            name = self._operated.name
            if name and name != asked_for:
                await self._read_axes(name)
            asked_for = name
            speed, turn = self._speed.value, self._turn.value
            twist = self._buttons.twist(self._link.now(), speed, turn)
            if twist is not None:
                await self._send(name, twist)

    async def _send(self, name: str, twist: list[float]) -> None:
        client = self._link.client
        with self._letting_go_when_refused():
            await client.command(name, twist, epoch=self._epoch)
            said = (await client.controller_state(name)).published.get("state", {})
            self._told = str(said.get("message", "")) if any(twist) else ""

    async def _read_axes(self, name: str) -> None:
        try:
            frame = (await self._link.client.gains(name)).values.get("frame", 0.0)
        except ApiError as error:
            self._reporter.refused(error, None)
        else:
            set_value(self._axes, AXES[int(frame)])

    async def _on_axes(self, event: Event[Any]) -> None:
        chosen = float(AXES.index(event.target.value))
        await self._link.client.set_gains(self._operated.name, {"frame": chosen})

    async def _on_hold(self, axis: int, sign: int, event: Event[Any]) -> None:
        if self._operated.reason or not self._operated.name:
            # Viser does not enforce `disabled`, so a disabled button can be held.
            self._reporter.say("Not sent", self._operated.reason, event.client)
        else:
            self._buttons.hold(axis, sign, self._link.now())

    async def _on_release(self, axis: int, sign: int, _event: Event[Any]) -> None:
        self._buttons.release(axis, sign)

    def _fit(self, operated: Operated) -> None:
        """Let the sliders of the speeds end at the limits of the controller."""
        for slider, element in (
            (self._speed, operated.elements[0]),
            (self._turn, operated.elements[3]),
        ):
            if element.maximum is not None:
                slider.max = element.maximum
                set_value(slider, min(slider.value, element.maximum))

    def _markup(self) -> str:
        if self._operated.reason:
            return hint(self._operated.reason)
        if self._told:
            return warning(self._told)
        return good(f"Hold a button to move; let go to stop ({self._operated.name}).")
