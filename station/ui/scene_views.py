"""What each browser session sees in the 3D view besides what all of them see.

Viser knows browsers, the gateway knows sessions: the relay tells Viser's door the key
of the session, so that a session's choice is drawn in its own browsers alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import viser

from station.ui.joint_frames import is_drawn_moving
from station.ui.robot_figure import RobotFigure
from station.ui.robot_model import RobotModel

MOST_KEPT = 512
"""Sessions whose choice is kept; those that chose longest ago are forgotten first."""
_GHOST_COLOUR = (138, 84, 214)
_LABEL_HEIGHT = 0.05  # [m]


@dataclass(frozen=True, slots=True)
class Ghost:
    """A pose that a session looks at: recorded, or one that a motion would go to.

    Attributes:
        positions: Joint positions by name [rad] or [m].
        label: What the pose is, shown above it; may be empty.
    """

    positions: Mapping[str, float]
    label: str = ""


@dataclass(slots=True)
class _Drawn:
    """What one browser shows of its session's choice."""

    client: viser.ClientHandle
    figures: list[RobotFigure] = field(default_factory=list)
    label: viser.LabelHandle | None = None


class SceneViews:
    """The views of all sessions. To be used from Viser's event loop only.

    Args:
        robots: The robots that are drawn.
        key_of: Returns the key of the session of a browser; empty when it is unknown.
    """

    def __init__(
        self,
        robots: Sequence[RobotModel],
        key_of: Callable[[viser.ClientHandle], str],
    ) -> None:
        self._robots = tuple(robots)
        self._key_of = key_of
        self._ghosts: dict[str, Ghost] = {}
        self._drawn: dict[int, _Drawn] = {}

    def joint_names(self) -> frozenset[str]:
        """Return the joints that a ghost can have a position for."""
        return frozenset(
            joint.name
            for robot in self._robots
            for joint in robot.urdf.joints.values()
            if is_drawn_moving(joint)
        )

    def joined(self, client: viser.ClientHandle) -> None:
        """Show a browser that has just connected what its session has chosen."""
        self._drawn[client.client_id] = _Drawn(client)
        self._show_ghost(self._drawn[client.client_id])

    def left(self, client: viser.ClientHandle) -> None:
        """Forget a browser."""
        self._drawn.pop(client.client_id, None)

    def show_ghost(self, key: str, ghost: Ghost | None) -> None:
        """Show a pose in the browsers of one session.

        Args:
            key: Key of the session.
            ghost: The pose; None hides it.
        """
        self._ghosts.pop(key, None)
        if ghost is not None:
            self._ghosts[key] = ghost
            if len(self._ghosts) > MOST_KEPT:
                self._ghosts.pop(next(iter(self._ghosts)))
        for drawn in self._drawn.values():
            if self._key_of(drawn.client) == key:
                self._show_ghost(drawn)

    def _show_ghost(self, drawn: _Drawn) -> None:
        ghost = self._ghosts.get(self._key_of(drawn.client))
        if ghost is None:
            for figure in drawn.figures:
                figure.hide()
            if drawn.label is not None:
                drawn.label.remove()
                drawn.label = None
            return
        if not drawn.figures:
            drawn.figures = [
                RobotFigure(drawn.client, robot, f"/ghost_{i}", _GHOST_COLOUR)
                for i, robot in enumerate(self._robots)
            ]
        for robot, figure in zip(self._robots, drawn.figures, strict=True):
            if ghost.positions.keys() & robot.urdf.joints.keys():
                figure.show(ghost.positions)
            else:
                figure.hide()
        self._show_label(drawn, ghost)

    def _show_label(self, drawn: _Drawn, ghost: Ghost) -> None:
        """Write above the ghost what it is."""
        if drawn.label is not None and drawn.label.text != ghost.label:
            drawn.label.remove()
            drawn.label = None
        named = [
            robot
            for robot in self._robots
            if ghost.positions.keys() & robot.urdf.joints
        ]
        if not ghost.label or not named:
            return
        bounds = named[0].bounds(ghost.positions)
        x, y, _ = bounds.mean(axis=0)
        above = (float(x), float(y), float(bounds[1, 2]) + _LABEL_HEIGHT)
        if drawn.label is None:
            drawn.label = drawn.client.scene.add_label(
                "/ghost_label", ghost.label, position=above
            )
        else:
            drawn.label.position = above
