"""Above the tabs: the errors of the arms, and a button that recovers the arms."""

from typing import Any

import viser
from typing_extensions import override

from station.ui.markup import hint, warning
from station.ui.panels.panel import Panel
from station.ui.recovery_model import Rescue, choose_rescue
from station.ui.reporter import Event, Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView


class RecoveryPanel(Panel):
    """Recovers arms and releases user stops; visible only when an arm needs it.

    Args:
        gui: Where it is built.
        link: The station.
        reporter: Says what went wrong.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        super().__init__(link, reporter)
        self._trouble = gui.add_html("", visible=False)
        self._button = gui.add_button(
            Rescue().label, color="orange", disabled=True, visible=False
        )
        self._reason = gui.add_html("", visible=False)
        self._button.on_click(reporter.guarded(self._on_click))

    @override
    def refresh(self, view: StationView) -> None:
        """Show the errors and what the button does about them."""
        rescue = choose_rescue(view)
        self._trouble.visible = bool(rescue.trouble)
        is_needed = bool(rescue.trouble or rescue.action)
        self._button.visible = self._reason.visible = is_needed
        self._trouble.content = warning(rescue.trouble) if rescue.trouble else ""
        self._button.label = rescue.label
        self._button.disabled = not rescue.action
        self._reason.content = hint(rescue.reason)

    async def _on_click(self, event: Event[Any]) -> None:
        rescue = choose_rescue(self._link.view())
        if not rescue.action:
            self._reporter.say("Not done", rescue.reason, event.client)
            return
        if rescue.action == "release":
            for arm_id in rescue.arms:
                await self._link.client.robot(arm_id).user_stop(pressed=False)
            done = "The user stop is released"
        else:
            await self._link.client.recover_all()
            done = f"Recovered {' and '.join(rescue.arms)}"
        await self._link.refresh_status()
        await self._link.refresh_controllers()
        text = f"{done}; the arm holds its pose. Start a controller to move it."
        self._reporter.done(text, event.client)
