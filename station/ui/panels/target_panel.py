"""The target in the 3D view that the end effector goes to when it is dragged."""

import asyncio
import math

import viser
from typing_extensions import override

from station.ui.cartesian_model import POSE, TargetPose, choose_cartesian
from station.ui.markup import good, hint, warning
from station.ui.panels.commanding_panel import CommandingPanel
from station.ui.reporter import Reporter
from station.ui.station_link import StationLink
from station.ui.station_view import StationView

KIND = "CartesianStreamingController"
_SEND_PERIOD = 0.04
_SIZE = 0.18
_HELD_FOR = 1.0


class TargetPanel(CommandingPanel):
    """A draggable frame at the end effector, and a text about the motion to it.

    Args:
        server: Where the frame and the text are shown.
        link: The station.
        reporter: Says what went wrong.
        base: Scene node of the arm's base frame.
        arm: The arm whose end effector goes to the target; empty where there are not
            several.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        link: StationLink,
        reporter: Reporter,
        base: str,
        arm: str = "",
    ) -> None:
        super().__init__(link, reporter)
        self._arm = arm
        self._target = TargetPose()
        self._desired: list[float] = []
        self._told = ""
        self._dragged_at = -math.inf
        whose = f"End effector of {arm}" if arm else "End effector"
        with server.gui.add_folder(f"{whose}: drag the target"):
            self._state = server.gui.add_html(hint("Waiting for the station …"))
        self._gizmo = server.scene.add_transform_controls(
            f"{base}/target{arm and f'_{arm}'}",
            scale=_SIZE,
            visible=False,
            depth_test=False,
        )
        self._gizmo.on_update(self._on_drag)

    @override
    def let_go(self) -> None:
        self._target.let_go()

    @override
    def refresh(self, view: StationView) -> None:
        """Let the target follow the arm until a person drags the target."""
        operated = choose_cartesian(view, POSE, KIND, self._arm)
        if operated.reason or operated.name != self._operated.name:
            self._desired = []
            self._told = ""
        self._operate(operated, view)
        sample = view.samples.get(operated.name)
        if sample is not None and len(sample.desired) == len(POSE):
            known = [value for value in sample.desired if value is not None]
            self._desired = known if len(known) == len(POSE) else []
        self._show()

    async def run(self) -> None:
        """Send the target while the arm approaches it, until cancelled."""
        while True:
            await asyncio.sleep(_SEND_PERIOD)
            if not self._desired or self._operated.reason:
                continue
            pose = self._target.command(self._desired, self._link.now())
            if pose is not None:
                await self._send(self._operated.name, pose)

    async def _send(self, name: str, pose: list[float]) -> None:
        client = self._link.client
        with self._letting_go_when_refused():
            await client.command(name, pose, epoch=self._epoch)
            said = (await client.controller_state(name)).published.get("state", {})
            self._told = str(said.get("message", ""))

    def _show(self) -> None:
        usable = bool(self._desired) and not self._operated.reason
        self._gizmo.visible = usable
        is_held = self._link.now() - self._dragged_at < _HELD_FOR
        if usable and not self._target.is_pursued and not is_held:
            x, y, z, qx, qy, qz, qw = self._desired
            self._gizmo.position = (x, y, z)
            self._gizmo.wxyz = (qw, qx, qy, qz)
        self._state.content = self._markup()

    def _markup(self) -> str:
        if self._operated.reason:
            return hint(self._operated.reason)
        if self._told:
            return warning(self._told)
        if self._target.is_pursued:
            return good(f"{self._operated.name} goes to the target.")
        return good(f"Drag the target at the gripper; {self._operated.name} follows.")

    async def _on_drag(self, event: viser.TransformControlsEvent) -> None:
        """Take the pose to which a person dragged the target."""
        if event.client is None or self._operated.reason or not self._desired:
            return
        self._dragged_at = self._link.now()
        x, y, z = (float(value) for value in event.target.position)
        w, i, j, k = (float(value) for value in event.target.wxyz)
        self._target.drag([x, y, z, i, j, k, w], self._link.now())
