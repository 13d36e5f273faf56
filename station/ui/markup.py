"""Small pieces of HTML for the panels; all texts of the station are escaped.

Only `currentColor` and translucent colours are used, so that the text is readable on
light and on dark pages. A word always states what a colour means.
"""

from collections.abc import Sequence
from html import escape

from station.ui.controllers_model import claims_text
from station.wire import ControllerState

_STATE_COLOURS = {
    "running": "rgba(47, 158, 68, .25)",
    "aborted": "rgba(224, 49, 49, .3)",
    "waiting": "rgba(240, 140, 0, .3)",
}
_IDLE_COLOUR = "rgba(134, 142, 150, .22)"
_BOX = "padding:.5em .75em;margin:0 .75em .5em;border-radius:6px;font-size:.85em;"


def hint(text: str) -> str:
    """Return a line with an explanation."""
    return f'<div style="{_BOX}padding-left:0;opacity:.8">{escape(text)}</div>'


def warning(text: str) -> str:
    """Return a box with the reason why an action is not possible."""
    return (
        f'<div role="status" style="{_BOX}background:rgba(240,140,0,.2);'
        f'border-left:3px solid rgb(240,140,0)">{escape(text)}</div>'
    )


def good(text: str) -> str:
    """Return a box with a message about the present state."""
    return (
        f'<div role="status" style="{_BOX}background:rgba(47,158,68,.18);'
        f'border-left:3px solid rgb(47,158,68)">{escape(text)}</div>'
    )


def controller_table(controllers: Sequence[ControllerState]) -> str:
    """Return the table of all loaded controllers."""
    rows = "".join(_row(controller) for controller in controllers)
    if not rows:
        return hint("No controller is loaded.")
    head = "".join(
        f'<th style="text-align:left;padding:.3em .5em;font-weight:500;opacity:.7">'
        f"{title}</th>"
        for title in ("Controller", "State", "Claims")
    )
    return (
        '<table aria-label="Loaded controllers" style="width:calc(100% - 1.5em);'
        "margin:0 .75em .5em;border-collapse:collapse;font-size:.85em;"
        f'line-height:1.35"><tr>{head}</tr>{rows}</table>'
    )


def _row(controller: ControllerState) -> str:
    colour = _STATE_COLOURS.get(controller.state, _IDLE_COLOUR)
    cell = (
        'style="padding:.4em .5em;border-top:1px solid rgba(134,142,150,.35);'
        'vertical-align:top;overflow-wrap:anywhere"'
    )
    fault = (
        f'<div style="font-size:.9em">Fault: {escape(controller.fault)}</div>'
        if controller.fault
        else ""
    )
    return (
        f"<tr><td {cell}><b>{_breakable(controller.name)}</b>"
        f'<div style="opacity:.7;font-size:.85em">{_breakable(controller.type)}</div>'
        f"{fault}</td><td {cell}>"
        f'<span style="background:{colour};padding:.1em .5em;border-radius:9px;'
        f'white-space:nowrap">{escape(controller.state)}</span></td>'
        f"<td {cell}>{escape(claims_text(controller))}</td></tr>"
    )


def _breakable(name: str) -> str:
    """Allow line breaks between the parts of a long name."""
    return escape(name).replace("/", "/<wbr>").replace("_", "_<wbr>")
