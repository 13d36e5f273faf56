"""The Controllers tab: list, start, stop, unload and load controllers."""

from typing import TYPE_CHECKING, Any, cast

import anyio.to_thread
import viser
from typing_extensions import override

from station.core.config_error import ConfigError
from station.core.yaml_reader import FORM, parse_yaml
from station.ui.controllers_model import Offer, offer_for, startable_first
from station.ui.load_examples import example_parameters, suggested_name, usefulness
from station.ui.markup import controller_table, hint, warning
from station.ui.panels.panel import Panel
from station.ui.reporter import Event, Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView
from station.ui.widgets import NONE, set_options, set_value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pydantic import JsonValue


class ControllersPanel(Panel):
    """A table of the controllers, and buttons for the chosen controller.

    Args:
        gui: Where the tab is built.
        link: The station.
        reporter: Says what went wrong.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        super().__init__(link, reporter)
        self._chosen = gui.add_dropdown("Controller", (NONE,), disabled=True)
        self._start = gui.add_button("Start", color="green", disabled=True)
        self._stop = gui.add_button("Stop", color="orange", disabled=True)
        self._unload = gui.add_button("Unload", color="gray", disabled=True)
        self._reason = gui.add_html("")
        self._table = gui.add_html(hint("Waiting for the station …"))
        self._start.on_click(reporter.guarded(self._on_start))
        self._stop.on_click(reporter.guarded(self._on_stop))
        self._unload.on_click(reporter.guarded(self._on_unload))
        self._load = LoadForm(gui, link, reporter)

    @override
    def refresh(self, view: StationView) -> None:
        """Show the controllers, and which buttons the chosen controller allows."""
        self._table.content = controller_table(view.controllers)
        names = tuple(c.name for c in view.controllers)
        if self._chosen.value == NONE and names:
            # People who open the tab want to start a controller that moves the robot.
            names_first = startable_first(view)
            set_options(self._chosen, names)
            set_value(self._chosen, names_first[0])
        set_options(self._chosen, names)
        offer = offer_for(view, self._chosen.value)
        self._start.label = _start_label(offer)
        blocked = bool(view.blocked())
        self._start.disabled = not (offer.start or (offer.replaces and not blocked))
        self._stop.disabled = not offer.stop
        self._unload.disabled = not offer.unload
        self._reason.content = hint(offer.reason) if offer.reason else ""
        self._load.refresh(view)

    async def _on_start(self, event: Event[Any]) -> None:
        name = self._chosen_name(event)
        if name == NONE:
            return
        offer = offer_for(self._link.view(), name)
        result = await self._link.client.switch_controllers(
            start=[name], stop=offer.replaces
        )
        await self._link.refresh_controllers()
        steps = [abs(jump) for jump in result.jump.values() if jump is not None]
        stopped = f", stopped {', '.join(result.stopped)}" if result.stopped else ""
        self._reporter.done(
            f"Started {', '.join(result.started)}{stopped}. "
            f"Largest step of a command: {max(steps, default=0.0):.4f}.",
            event.client,
        )

    async def _on_stop(self, event: Event[Any]) -> None:
        name = self._chosen_name(event)
        if name == NONE:
            return
        result = await self._link.client.switch_controllers(stop=[name])
        await self._link.refresh_controllers()
        text = f"Stopped {', '.join(result.stopped)}; the robot holds its pose."
        self._reporter.done(text, event.client)

    async def _on_unload(self, event: Event[Any]) -> None:
        name = self._chosen_name(event)
        if name == NONE:
            return
        gone = await self._link.client.unload_controller(name)
        await self._link.refresh_controllers()
        self._reporter.done(f"Unloaded {gone.name}.", event.client)

    def _chosen_name(self, event: Event[Any]) -> str:
        """Return the chosen controller; without one, tell the person who clicked."""
        name = self._chosen.value
        if name == NONE:
            self._reporter.say("Not done", "No controller is loaded.", event.client)
        return name


class LoadForm:
    """Name, type and parameters of a controller to load.

    Args:
        gui: Where the form is built.
        link: The station.
        reporter: Says what went wrong.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        self._link = link
        self._reporter = reporter
        self._example = ""
        with gui.add_folder("Load a controller"):
            self._type = gui.add_dropdown("Type", (NONE,), disabled=True)
            self._name = gui.add_text("Name", "")
            self._params = gui.add_text("Parameters", "", multiline=True)
            self._problem = gui.add_html("")
            self._button = gui.add_button("Load", disabled=True)
        self._type.on_update(reporter.guarded(self._on_type))
        self._button.on_click(reporter.guarded(self._on_load))

    def refresh(self, view: StationView) -> None:
        """Offer the types of controllers that the station can load."""
        types = tuple(sorted((t.type for t in view.types), key=usefulness))
        before = self._type.value
        set_options(self._type, types)
        if self._type.value != before or not self._example:
            self._suggest(view)
        self._button.disabled = view.link != "live" or not types

    def _suggest(self, view: StationView) -> None:
        """Prefill name and parameters, so that Load works at once."""
        if self._type.value == NONE or not view.positions:
            return
        taken = [c.name for c in view.controllers]
        self._example = example_parameters(self._type.value, view.positions)
        set_value(self._name, suggested_name(self._type.value, taken))
        set_value(self._params, self._example)

    async def _on_type(self, _event: Event[Any]) -> None:
        self._suggest(self._link.view())

    async def _on_load(self, event: Event[Any]) -> None:
        try:
            read = await anyio.to_thread.run_sync(
                parse_yaml, self._params.value, "Parameters", FORM
            )
        except ConfigError as error:
            self._problem.content = warning(f"{error.message} {error.remedy}")
            return
        self._problem.content = ""
        # What YAML has besides JSON, infinity, the request refuses.
        params = cast("Mapping[str, JsonValue]", read.values)
        loaded = await self._link.client.load_controller(
            self._name.value.strip(), self._type.value, params
        )
        await self._link.refresh_controllers()
        self._reporter.done(f"Loaded {loaded.name}. Start it above.", event.client)
        self._suggest(self._link.view())


def _start_label(offer: Offer) -> str:
    if offer.replaces:
        return f"Stop {', '.join(offer.replaces)} and start this"
    return "Start"
