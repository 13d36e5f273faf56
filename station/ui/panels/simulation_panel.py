"""The Simulation tab: pause, single-step, slow down and reset a simulated robot."""

from typing import Any

import viser
from typing_extensions import override

from station.ui.markup import good, hint, warning
from station.ui.panels.panel import Panel
from station.ui.reporter import Event, Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView
from station.wire import Simulation

PACES = {"1/10": 0.1, "1/4": 0.25, "1/2": 0.5, "1": 1.0}
"""Paces to choose among; a simulation faster than real time takes a fast machine."""


class SimulationPanel(Panel):
    """Buttons for simulated time and for the simulated world.

    Args:
        gui: Where the tab is built.
        link: The station.
        reporter: Says what went wrong.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        super().__init__(link, reporter)
        self._state = gui.add_html(hint("Waiting for the station …"))
        self._pause = gui.add_button("Pause", disabled=True)
        self._step = gui.add_button("Step one cycle", disabled=True)
        self._steps = gui.add_button("Step 100 cycles", disabled=True)
        self._pace = gui.add_dropdown(
            "Pace", tuple(PACES), initial_value="1", disabled=True
        )
        self._reset = gui.add_button("Reset the world", color="orange", disabled=True)
        gui.add_html(
            hint(
                "A reset puts the robot and all objects where they began. Running "
                "controllers start anew from there; set-points and goals are void."
            )
        )
        self._pause.on_click(reporter.guarded(self._on_pause))
        self._step.on_click(reporter.guarded(lambda event: self._on_step(event, 1)))
        self._steps.on_click(reporter.guarded(lambda event: self._on_step(event, 100)))
        self._pace.on_update(reporter.guarded(self._on_pace))
        self._reset.on_click(reporter.guarded(self._on_reset))

    @override
    def refresh(self, view: StationView) -> None:
        """Show how time passes, or why the buttons are disabled."""
        found = None if view.status is None else view.status.simulation
        live = view.link == "live" and found is not None
        paused = found is not None and found.paused
        self._pause.label = "Resume" if paused else "Pause"
        for widget in (self._pause, self._pace, self._reset):
            widget.disabled = not live
        for button in (self._step, self._steps):
            button.disabled = not (live and paused)
        self._state.content = _describe(view, found)

    async def _on_pause(self, event: Event[Any]) -> None:
        simulation = self._link.client.simulation
        if (await simulation.state()).paused:
            await simulation.resume()
            self._reporter.done("Simulated time passes again.", event.client)
        else:
            await simulation.pause()
            self._reporter.done("Simulated time stands still.", event.client)
        await self._link.refresh_status()

    async def _on_step(self, event: Event[Any], cycles: int) -> None:
        state = await self._link.client.simulation.step(cycles)
        await self._link.refresh_status()
        text = f"{cycles} cycles; {state.time:.3f} s are simulated."
        self._reporter.done(text, event.client)

    async def _on_pace(self, event: Event[Any]) -> None:
        factor = PACES[self._pace.value]
        await self._link.client.simulation.set_real_time_factor(factor)
        await self._link.refresh_status()
        self._reporter.done(f"The pace is {factor:g} of real time.", event.client)

    async def _on_reset(self, event: Event[Any]) -> None:
        await self._link.client.simulation.reset()
        await self._link.refresh_status()
        self._reporter.done("The world is where it began.", event.client)


def _describe(view: StationView, found: Simulation | None) -> str:
    if view.link != "live" or view.status is None:
        return warning(f"The link to the station is {view.link}.")
    if found is None:
        robot = view.status.robot_type
        return warning(f"{robot} is not simulated: its time cannot be stopped.")
    if found.paused:
        return warning(
            f"Paused at {found.time:.3f} s. Nothing moves; stops and switches work."
        )
    return good(
        f"Running at {found.real_time_factor:g} of real time; {found.time:.1f} s are "
        "simulated."
    )
