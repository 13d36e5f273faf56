"""The panel that Viser draws: sliders of joints and gains, and arrows at the hands.

The panel is one for all browsers. Everything runs on Viser's own event loop.
"""

import asyncio
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from itertools import zip_longest
from typing import Any, TypeVar

import viser

from station.client import ApiError
from station.ui.link.station_link import StationLink
from station.ui.link.station_view import Limits, StationView
from station.ui.teleoperation.reporter import Event, Reporter
from station.ui.teleoperation.teleoperation import Teleoperation
from station.wire import CommandElement, Gains

GAIN_REACH = 100.0
"""Right end of the slider of a gain whose value is zero."""
# A continuous joint can be turned by one turn to each side.
_DEFAULT_SPAN = {"rad": 2.0 * math.pi, "m": 1.0, "rad/s": 1.0, "m/s": 0.5, "Nm": 10.0}


@dataclass(frozen=True, slots=True)
class SliderScale:
    """The ends of a slider and the distance between two positions.

    Attributes:
        minimum: Left end.
        maximum: Right end, > minimum.
        step: Distance between two positions of the thumb.
    """

    minimum: float
    maximum: float
    step: float

    def clamp(self, value: float) -> float:
        """Return the nearest value the slider can show."""
        return min(max(value, self.minimum), self.maximum)


def command_scale(
    unit: str, minimum: float | None, maximum: float | None
) -> SliderScale:
    """Return the scale for one element of a set-point.

    Args:
        unit: The element's unit.
        minimum: Smallest value allowed; None where unlimited.
        maximum: Largest value allowed; None where unlimited.
    """
    span = _DEFAULT_SPAN.get(unit, 1.0)
    low = -span if minimum is None else minimum
    high = span if maximum is None else maximum
    # Rounded inwards, because the station refuses a value beyond its range.
    low, high = math.ceil(low * 1e3 - 1e-6) / 1e3, math.floor(high * 1e3 + 1e-6) / 1e3
    if high <= low:
        high = low + 1e-3
    return SliderScale(low, high, 1e-3)


def gain_scale(
    value: float, minimum: float | None, maximum: float | None
) -> SliderScale:
    """Return the scale for a gain whose allowed range may be too wide for a slider.

    The slider ends at a round number above twice the present value; the number
    entry beside it takes the whole allowed range.

    Args:
        value: Present value.
        minimum: Smallest value allowed; None where unlimited.
        maximum: Largest value allowed; None where unlimited.
    """
    reach = _round_up(2.0 * abs(value) or GAIN_REACH)
    low = (-reach if value < 0.0 else 0.0) if minimum is None else max(minimum, -reach)
    high = reach if maximum is None else min(maximum, reach)
    if high <= low:
        high = low + 1.0
    return SliderScale(low, high, _round_up((high - low) / 1000.0))


def _round_up(value: float) -> float:
    """Return the next of 1, 2, 5, 10, 20, … that is at least `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    for factor in (1.0, 2.0, 5.0):
        if value <= factor * power * (1.0 + 1e-9):
            return float(f"{factor * power:.12g}")
    return float(f"{10.0 * power:.12g}")


_Value = TypeVar("_Value", float, str, bool)
NONE = "(none)"
"""The option of a dropdown when there is nothing to choose."""
GENERAL = "general"
"""Name of the group of gains that belong to no joint."""
_GAINS_PERIOD = 1.0
# Viser sends a value for each pixel of a drag; only the last one is meant.
_SETTLE = 0.12
# A slider that was just released would jump back to the value that was asked before.
_FOLLOW_AGAIN = 1.5
_ARROWS_SIZE = 0.18
_HELD_FOR = 1.0
_BOX = "padding:.5em .75em;margin:0 .75em .5em;border-radius:6px;font-size:.85em;"


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


class JointSliders:
    """A slider per joint; the sliders follow the robot until a person moves one.

    Args:
        gui: Panel that gets the sliders.
        teleoperation: The commands of this panel.
        reporter: Shows refusals.
        limits: Position limits of the robot's joints, for disabled sliders that only
            show the robot; limits that the station reports take precedence.

    Attributes:
        teleoperation: The commands of this panel.
        state: Text that says whether the sliders command, or why not.
        speed: The highest speed of the joints [rad/s].
        sliders: The sliders by joint.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        teleoperation: Teleoperation,
        reporter: Reporter,
        limits: Limits,
    ) -> None:
        self._gui = gui
        self.teleoperation = teleoperation
        self._reporter = reporter
        self._limits = limits
        self.state = gui.add_html(hint("Waiting for the station …"))
        self.speed = gui.add_slider(
            "Top speed [rad/s]", min=0.05, max=1.5, step=0.05, initial_value=0.5
        )
        self._folder = gui.add_folder("Joints")
        self.sliders: dict[str, FollowingSlider] = {}
        self._shown: tuple[CommandElement, ...] = ()

    def refresh(self, view: StationView) -> None:
        """Follow the robot, or show why the sliders are disabled."""
        joints = self.teleoperation.joints
        joints.set_speed(self.speed.value)
        elements = joints.elements or self._joint_elements(view)
        if elements != self._shown:
            self._build(elements)
        commanded = bool(joints.elements) and not joints.reason
        for name, following in self.sliders.items():
            slider = following.slider
            slider.disabled = not commanded
            value = (
                joints.shown(name, view.now) if commanded else view.positions.get(name)
            )
            if value is not None:
                following.show(round(min(max(value, slider.min), slider.max), 3))
        self.state.content = self._state_markup()

    def _state_markup(self) -> str:
        joints = self.teleoperation.joints
        if joints.reason:
            return warning(joints.reason)
        names = ", ".join(joints.controllers)
        if joints.remaining:
            return good(f"Moving {names}: {joints.remaining:.2f} rad to go.")
        return good(f"Sliders command {names} and follow it until you touch one.")

    def _joint_elements(self, view: StationView) -> tuple[CommandElement, ...]:
        """Return elements for sliders that only show the positions of the joints."""
        known = {**self._limits, **view.limits}
        return tuple(
            CommandElement(
                name=name,
                unit="m" if "finger" in name else "rad",
                minimum=known[name][0],
                maximum=known[name][1],
            )
            for name in view.positions
            if name in known
        )

    def _build(self, elements: tuple[CommandElement, ...]) -> None:
        for old in self.sliders.values():
            old.slider.remove()
        self.sliders = {}
        self._shown = elements
        with self._folder:
            for element in elements:
                scale = command_scale(element.unit, element.minimum, element.maximum)
                slider = self._gui.add_slider(
                    f"{_short_name(element.name, elements)} [{element.unit}]",
                    min=scale.minimum,
                    max=scale.maximum,
                    step=scale.step,
                    initial_value=scale.clamp(0.0),
                    disabled=True,
                    hint=f"{element.name}: "
                    f"{_range_text(scale.minimum, scale.maximum, element.unit)}.",
                )
                touched = partial(self._on_touch, element.name)
                slider.on_update(self._reporter.guarded(touched))
                self.sliders[element.name] = FollowingSlider(slider)

    async def _on_touch(self, name: str, event: Event[Any]) -> None:
        value = event.target.value
        self.sliders[name].taken()
        now = self.teleoperation.now()
        # Viser does not enforce `disabled`: a disabled slider can be moved.
        refusal = self.teleoperation.joints.go({name: value}, now)
        if refusal:
            self._reporter.say("Not sent", refusal, event.client)


class GainSliders:
    """A slider per gain of one joint of one controller.

    Args:
        gui: Panel that gets the sliders.
        link: The station.
        reporter: Shows refusals.

    Attributes:
        chosen: The choice of a controller.
        group: The choice of a joint.
        note: Text about the effect of a change, or the reason why there is none.
        sliders: The sliders by gain.
    """

    def __init__(
        self, gui: viser.GuiApi, link: StationLink, reporter: Reporter
    ) -> None:
        self._gui = gui
        self._link = link
        self._reporter = reporter
        self._gains: Gains | None = None
        self._gains_of = ""
        self.chosen = gui.add_dropdown("Controller", (NONE,), disabled=True)
        self._chosen_by_hand = False
        self.chosen.on_update(reporter.guarded(self._on_choice))
        self.group = gui.add_dropdown("Joint", (NONE,), disabled=True)
        self._folder = gui.add_folder("Gains")
        with self._folder:
            self.note = gui.add_html(hint("Waiting for the station …"))
        self.sliders: dict[str, FollowingSlider] = {}
        self._built_for: tuple[str, str] = ("", "")
        self._touched_at = float("-inf")
        self._pending: dict[str, float] = {}

    def refresh(self, view: StationView) -> None:
        """Show the gains of the chosen joint."""
        tunable = tunable_controllers(view)
        set_options(self.chosen, tuple(tunable))
        # The running controller, until a person has chosen one.
        if tunable and not self._chosen_by_hand:
            set_value(self.chosen, tunable[0])
        gains = self._gains if self._gains_of == self.chosen.value else None
        groups = gain_groups(gains.values) if gains else {}
        if groups:  # Else keep the choice until they are known again.
            set_options(self.group, tuple(groups))
        if gains is None:
            self._clear()
        else:
            self._show_gains(gains, groups.get(self.group.value, []), view)
        self.note.content = self._note_markup(view, gains)

    async def run(self) -> None:
        """Ask for the gains of the chosen controller, until cancelled."""
        while True:
            await self._read_gains(self.chosen.value)
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
        following = view.now - self._touched_at > _FOLLOW_AGAIN
        for name, slider in self.sliders.items():
            slider.slider.disabled = view.link != "live"
            if following:
                _follow_gain(slider, gains, name)

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
                    hint=_allowed_text(name, gains),
                )
                slider.on_update(self._reporter.guarded(partial(self._on_gain, name)))
                self.sliders[name] = FollowingSlider(slider)

    def _clear(self) -> None:
        for old in self.sliders.values():
            old.slider.remove()
        self.sliders.clear()
        self._built_for = ("", "")

    async def _on_choice(self, _event: Event[Any]) -> None:
        self._chosen_by_hand = True

    async def _on_gain(self, name: str, event: Event[Any]) -> None:
        """Send a gain once the slider has rested for a moment."""
        self._touched_at = self._link.now()
        controller = self._gains_of
        value = float(event.target.value)
        if name in self.sliders:
            self.sliders[name].taken()
        self._pending[name] = value
        await asyncio.sleep(_SETTLE)
        # The slider was moved again meanwhile; that value is sent.
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
        if self.chosen.value == NONE:
            return hint("No controller that commands joints is loaded.")
        if gains is None or not gains.values:
            return hint(f"{self.chosen.value} has no gains to tune.")
        return hint("A change takes effect at once, in one cycle.")


class HandArrows:
    """Arrows at an end effector: it follows them when a person drags them.

    Args:
        server: Viser server that draws the arrows.
        teleoperation: The commands of this panel.
        reporter: Shows what is in the way of a hand.
        base: Scene node of the arm's base frame.
        arm: The arm of the end effector; empty unless there are several.

    Attributes:
        teleoperation: The commands of this panel.
        gizmo: The arrows.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        teleoperation: Teleoperation,
        reporter: Reporter,
        base: str,
        arm: str = "",
    ) -> None:
        self.teleoperation = teleoperation
        self._reporter = reporter
        self._dragger: viser.ClientHandle | None = None
        self._said = ""
        self._arm = arm
        self._dragged_at = float("-inf")
        self.gizmo = server.scene.add_transform_controls(
            f"{base}/target{arm and f'_{arm}'}",
            scale=_ARROWS_SIZE,
            visible=False,
            depth_test=False,
        )
        self.gizmo.on_update(self._on_drag)

    def refresh(self, view: StationView) -> None:
        """Let the arrows follow the arm until a person drags them."""
        hand = self.teleoperation.hands.of(self._arm)
        usable = hand is not None and not hand.target.reason and bool(hand.desired)
        self.gizmo.visible = usable
        is_held = view.now - self._dragged_at < _HELD_FOR
        if hand is None or hand.desired is None or not usable:
            return
        # The dock says so, too, but who drags the arrows need not have it open.
        said, self._said = self._said, hand.message if hand.is_pursuing else ""
        if self._said not in {"", said}:
            self._reporter.say("The hand stops short", self._said, self._dragger)
        # Arrows that followed while they are dragged would fight with the pointer.
        if not hand.is_pursuing and not is_held:
            x, y, z, qx, qy, qz, qw = hand.desired
            self.gizmo.position = (x, y, z)
            self.gizmo.wxyz = (qw, qx, qy, qz)

    async def _on_drag(self, event: viser.TransformControlsEvent) -> None:
        """Let the hand go to the pose to which a person dragged the arrows."""
        # Viser also calls this when the arrows follow the arm.
        if event.client is None:
            return
        self._dragged_at, self._dragger = self.teleoperation.now(), event.client
        x, y, z = (float(value) for value in event.target.position)
        w, i, j, k = (float(value) for value in event.target.wxyz)
        self.teleoperation.hands.go(self._arm, [x, y, z, i, j, k, w], self._dragged_at)


def bases_of_hands(arms: Sequence[str], bases: Sequence[str]) -> dict[str, str]:
    """Return the scene node of the base of each hand that can be moved, by arm.

    Args:
        arms: The arms that are drawn.
        bases: Scene nodes of their bases; fewer where a robot could not be drawn.

    Returns:
        Scene node by arm; for a single arm one entry whose name is empty.
    """
    if len(arms) < 2:
        return {"": bases[0] if bases else ""}
    return dict(zip_longest(arms, bases[: len(arms)], fillvalue=""))


def tunable_controllers(view: StationView) -> list[str]:
    """Return the controllers that claim a resource, the running controllers first."""
    names = [
        c.name
        for c in view.controllers
        if any(claim.resources for claim in c.claimed_resources)
    ]
    running = {c.name for c in view.controllers if c.state == "running"}
    return sorted(names, key=lambda name: (name not in running, name))


def gain_groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Group gains by the joint to which they belong.

    Args:
        names: Names of gains, e.g. `panda_joint1/p`.

    Returns:
        The gains by the name of the joint, in the order given; gains without a joint
        are under `GENERAL`.
    """
    groups: dict[str, list[str]] = {}
    for name in names:
        group = name.rpartition("/")[0] or GENERAL
        groups.setdefault(group, []).append(name)
    return groups


def gain_label(name: str, unit: str) -> str:
    """Return a slider's label: the gain's own name and its unit."""
    short = name.rpartition("/")[2].replace("_", " ")
    return f"{short} [{unit}]" if unit else short


def set_value(widget: viser.GuiInputHandle[_Value], value: _Value) -> None:
    """Set the value that an input shows, in all browsers."""
    # Viser's setter is real, but mypy does not see it: a method stands in between.
    widget.value = value  # type: ignore[misc]


def set_options(dropdown: viser.GuiDropdownHandle[str], names: tuple[str, ...]) -> None:
    """Offer these names; the chosen name stays chosen while it is offered."""
    options = names or (NONE,)
    if tuple(dropdown.options) != options:
        dropdown.options = options
    dropdown.disabled = not names


def hint(text: str) -> str:
    """Return a line with an explanation, in HTML; the text is escaped."""
    return f'<div style="{_BOX}padding-left:0;opacity:.8">{escape(text)}</div>'


def warning(text: str) -> str:
    """Return a box with the reason why an action is not possible, in HTML."""
    return _box(text, "240,140,0")


def good(text: str) -> str:
    """Return a box with a message about the present state, in HTML."""
    return _box(text, "47,158,68")


def _box(text: str, colour: str) -> str:
    # A translucent background is readable on light and on dark pages.
    style = f"{_BOX}background:rgba({colour},.2);border-left:3px solid rgb({colour})"
    return f'<div role="status" style="{style}">{escape(text)}</div>'


def _follow_gain(following: FollowingSlider, gains: Gains, name: str) -> None:
    value, slider = gains.values[name], following.slider
    if slider.value == value or following.is_moved():
        return
    allowed = gains.tunables[name]
    scale = gain_scale(value, allowed.minimum, allowed.maximum)
    slider.min, slider.max = min(slider.min, scale.minimum), scale.maximum
    slider.step = scale.step
    following.show(value)


def _allowed_text(name: str, gains: Gains) -> str:
    allowed = gains.tunables[name]
    bounds = _range_text(allowed.minimum, allowed.maximum, allowed.unit)
    return f"{allowed.description} Allowed: {bounds}.".strip()


def _range_text(minimum: float | None, maximum: float | None, unit: str) -> str:
    low = "-∞" if minimum is None else f"{minimum:g}"
    high = "∞" if maximum is None else f"{maximum:g}"
    return f"{low} to {high} {unit}".strip()


def _short_name(name: str, elements: tuple[CommandElement, ...]) -> str:
    """Return a name without the prefix of all elements, e.g. `joint1`."""
    prefix = name.partition("_")[0] + "_"
    shared = all(element.name.startswith(prefix) for element in elements)
    return name.removeprefix(prefix) if shared and len(elements) > 1 else name
