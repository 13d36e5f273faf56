"""Build the dashboard: the robot in 3D, Viser's panel, and the loop that updates them.

Everything that touches Viser runs on Viser's own event loop, so that no two threads
ever set widgets at the same time.
"""

import asyncio
import contextlib
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import viser

from station.client import AsyncStationClient
from station.ui.link.station_link import StationLink
from station.ui.link.station_view import StationView
from station.ui.page.page_state import BarState, bar_state
from station.ui.page.view_routes import ShownViews
from station.ui.scene.layers.drag_layers import Pusher, Pushing, act_for_nobody
from station.ui.scene.layers.layer import PlacedRobot, SceneFacts
from station.ui.scene.layers.robot_layers import Trails
from station.ui.scene.robot_model import RobotModel, RobotModelError, base_positions
from station.ui.scene.robot_scene import RobotScene, prepare_room
from station.ui.scene.scene_objects import SceneObjects
from station.ui.scene.scene_views import SceneViews, paint
from station.ui.teleoperation.joint_teleoperation import Movers
from station.ui.teleoperation.reporter import Reporter
from station.ui.teleoperation.teleoperation import Teleoperation
from station.ui.teleoperation.viser_panel import (
    GainSliders,
    HandArrows,
    JointSliders,
    bases_of_hands,
)

if TYPE_CHECKING:
    from concurrent.futures import Future

_logger = logging.getLogger(__name__)

SCENE_PERIOD = 0.1
"""Longest time between two checks for moved parts of the scene [s]. The robot is drawn
as soon as its positions come, because checks at a fixed rate would make them older."""
VIEWS_PERIOD = 1.0 / 15.0
PANEL_PERIOD = 0.1
_ENDING_TIME = 0.5
_PANEL_WIDTH = 430.0


class Dashboard:
    """The dashboard of one station, in one Viser server.

    Args:
        server: The Viser server that shows the dashboard.
        client: The station; used from Viser's event loop only.
        robot: The robot with its visual meshes; None shows no robot.
        not_drawn: Why no robot is shown; empty if no robot was requested.
        beside: Further robots of the same station.
        session_key: Returns the key of the session of a browser.
        push: Pushes a link for a session.
        move: Moves an object for a session.

    Attributes:
        views: The views of all sessions.
        triangles: How many triangles the drawn robots have.
        not_drawn: Why no robot is shown; empty if no robot was requested.
        movers: The mover of each joint, shared by all that command joints.
        link: The station.
        reporter: Shows refusals.
        scene: The first robot; None when none is drawn.
        sliders: Sliders of the joints.
        gains: Sliders of the gains.
        arrows: Arrows at the hands.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        client: AsyncStationClient,
        robot: RobotModel | None,
        not_drawn: str = "",
        beside: Sequence[RobotModel] = (),
        session_key: Callable[[viser.ClientHandle], str] = lambda _: "",
        push: Pusher = act_for_nobody,
        move: Callable[[str, str, list[float]], Awaitable[None]] = act_for_nobody,
    ) -> None:
        self._server = server
        self._client = client
        robots = beside if robot is None else (robot, *beside)
        sliding = {name for one in robots for name in one.sliding_joints()}
        self.link = StationLink(client, sliding=sliding)
        self.reporter = Reporter(self.link.now)
        self._failures = 0
        self._objects = SceneObjects(server)
        self.scene: RobotScene | None = None
        self._beside: list[RobotScene] = []
        if robot is None:
            prepare_room(server)
        else:
            not_drawn = self._draw(robot, beside) or not_drawn
        self.not_drawn = not_drawn
        placed = _placed(() if self.scene is None else (robot, *beside))
        self.triangles = sum(one.model.triangles() for one in placed)
        pushing = Pushing(push, self.reporter.refused, move=move)
        self.views = SceneViews(
            placed, session_key, pushing, lambda: server.initial_camera.position
        )
        self._trails = Trails(placed)
        self.movers = Movers()
        self._teleoperation = Teleoperation(
            client, self.link.view, self.movers, now=self.link.now
        )
        _arrange(server)
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Joints"):
            limits: dict[str, tuple[float, float]] = {}
            for one in robots:
                limits |= one.joint_limits()
            self.sliders = JointSliders(
                server.gui, self._teleoperation, self.reporter, limits
            )
        with tabs.add_tab("Gains"):
            self.gains = GainSliders(server.gui, self.link, self.reporter)
        nodes = [one.base for one in (self.scene, *self._beside) if one]
        bases = bases_of_hands([one.arm_id for one in robots], nodes)
        self.arrows = [
            HandArrows(server, self._teleoperation, self.reporter, base, arm)
            for arm, base in bases.items()
        ]
        self._running: Future[None] | None = None
        self._task: asyncio.Task[None] | None = None

    def _draw(self, robot: RobotModel, beside: Sequence[RobotModel]) -> str:
        """Draw the robots; return why that cannot be done, or an empty text."""
        try:
            self.scene = RobotScene(self._server, robot, beside=beside)
            self._beside = [
                RobotScene(self._server, other, root=f"/robot_{i}", has_camera=False)
                for i, other in enumerate(beside, start=2)
            ]
        except RobotModelError as error:
            _logger.warning("%s", error)
            return str(error)
        return ""

    def start(self) -> None:
        """Start to follow the station."""
        self._server.on_client_connect(self._on_connect)
        self._server.on_client_disconnect(self._on_disconnect)
        loop = self._server.get_event_loop()
        self._running = asyncio.run_coroutine_threadsafe(self._run(), loop)

    async def stop(self) -> None:
        """Stop following the station; waits a short time for the end."""
        if self._running is None:
            return
        ended = asyncio.run_coroutine_threadsafe(
            self._end(), self._server.get_event_loop()
        )
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(asyncio.wrap_future(ended), _ENDING_TIME)

    async def _end(self) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.wait({self._task})

    def bar(self) -> BarState:
        """Return the present content of the status strip; callable by any thread."""
        return bar_state(self.link.view(), self.reporter.message)

    def view(self) -> StationView:
        """Return the dashboard's knowledge of the station; callable by any thread."""
        return self.link.view()

    def shown_views(self) -> ShownViews:
        """Return `views` for threads other than Viser's."""
        loop = self._server.get_event_loop()
        return ShownViews(self.views, loop.call_soon_threadsafe)

    def talk_to(self, url: str, token: str | None) -> None:
        """Follow another station from now on; in Viser's event loop.

        Args:
            url: Its API.
            token: The operator's token; None while there is no station.
        """
        self._client.talk_to(url, token)
        self.link.wake()

    def act_under(self, lease: str | None) -> None:
        """Act under another lease of control; in Viser's event loop.

        A motion that was asked for under the former lease does not go on by itself.

        Args:
            lease: The lease of a browser of this dashboard; None without one.
        """
        # What one holder of control asked for must not go on under the next lease.
        self._client.lease.act_under(lease)
        self._teleoperation.let_go()

    # Viser calls coroutines in its event loop, where the views belong.
    async def _on_connect(self, client: viser.ClientHandle) -> None:
        self.views.joined(client)

    async def _on_disconnect(self, client: viser.ClientHandle) -> None:
        self.views.left(client)

    async def _run(self) -> None:
        self._task = asyncio.current_task()
        async with self._client, asyncio.TaskGroup() as tasks:
            tasks.create_task(self.link.run())
            tasks.create_task(self.gains.run())
            tasks.create_task(self._send_set_points())
            # Apart from the panel: a slow update of widgets must not delay the picture.
            tasks.create_task(self._follow_robot())
            tasks.create_task(self._repeat(self._refresh_views, VIEWS_PERIOD))
            tasks.create_task(self._repeat(self._refresh_panel, PANEL_PERIOD))

    def _show_robot(self) -> None:
        view = self.link.view()
        self._objects.show(view.objects)
        for scene in (self.scene, *self._beside):
            if scene is not None:
                scene.show(_drawn(view))

    def _refresh_views(self) -> None:
        self.link.wants_contacts = "forces" in self.views.wanted()
        view = self.link.view()
        positions = _drawn(view)
        self.views.refresh(
            SceneFacts(
                positions=positions,
                commanded=view.commanded_positions(),
                limits=view.limits,
                arms=view.arms,
                contacts=view.contacts,
                trails=self._trails.note(positions) if positions else (),
                objects=view.objects,
            )
        )

    def _refresh_panel(self) -> None:
        view = self.link.view()
        self.sliders.refresh(view)
        self.gains.refresh(view)
        for arrows in self.arrows:
            arrows.refresh(view)
        # A motion begins at the last set-point of its controller, which samples have.
        asked = self._teleoperation
        watched = {*asked.joints.controllers, *asked.hands.targets()}
        if "command" in self.views.wanted():
            watched |= view.commanding_positions()
        self.link.watch(watched)

    async def _send_set_points(self) -> None:
        """Send the set-points of Viser's panel, until cancelled."""
        while True:
            await self._teleoperation.wait_until_due()
            for refusal in await self._teleoperation.send_set_points():
                text = f"{refusal.detail} {refusal.remedy}".rstrip()
                self.reporter.say(refusal.code, text, None)

    async def _repeat(self, refresh: Callable[[], None], period: float) -> None:
        """Call `refresh` until cancelled."""
        while True:
            self._try(refresh)
            await asyncio.sleep(period)

    async def _follow_robot(self) -> None:
        """Draw the robot whenever it has moved, until cancelled."""
        while True:
            self._try(self._show_robot)
            await self.link.wait_for_motion(SCENE_PERIOD)

    def _try(self, refresh: Callable[[], None]) -> None:
        """Call `refresh`; a failure is logged once and shown."""
        try:
            refresh()
        except Exception as error:  # the boundary of the screen's updates
            self._failures += 1
            # An update that fails is repeated ten times a second.
            if self._failures in {1, 10, 100, 1000}:
                _logger.exception("update %d of the screen failed", self._failures)
            self.reporter.say("The dashboard failed", repr(error), None)


def _drawn(view: StationView) -> Mapping[str, float]:
    """Return the positions of all joints, those that carry a moving base included."""
    if view.base is None:
        return view.positions
    return {**view.positions, **base_positions(view.base)}


def _placed(robots: Sequence[RobotModel | None]) -> list[PlacedRobot]:
    """Return the robots with the scene nodes that `Dashboard` draws them at."""
    return [
        PlacedRobot(model, "/robot" if i == 1 else f"/robot_{i}")
        for i, model in enumerate(robots, start=1)
        if model is not None
    ]


def _arrange(server: viser.ViserServer) -> None:
    paint(server, is_dark=False)
    server.gui.main_panel.dock_right()
    server.gui.main_panel.set_width(_PANEL_WIDTH)
    # The docks of the page do what this panel does; a click on its rail opens it.
    server.gui.main_panel.minimize()
