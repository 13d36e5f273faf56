"""Frames in a Viser scene that follow the joints of a robot."""

from collections.abc import Mapping
from dataclasses import dataclass

import viser

from station.core.description.urdf import Joint
from station.ui.joint_frames import pose_at, position_among

Place = viser.ViserServer | viser.ClientHandle
"""Where something is drawn: in all browsers, or in one."""
_SMALLEST_STEP = 1e-4


@dataclass(frozen=True, slots=True)
class MovingFrame:
    """The frame of a link and the joint that moves it."""

    joint: Joint
    handle: viser.FrameHandle


class MovingFrames:
    """Moves the frames of one robot. To be used from Viser's event loop only.

    Args:
        place: Where the frames are drawn.
        frames: The frames.

    Attributes:
        shown: The positions that are drawn, by joint [rad] or [m].
    """

    def __init__(self, place: Place, frames: list[MovingFrame]) -> None:
        self._place = place
        self._frames = frames
        self.shown: dict[str, float] = {}

    def frame_of(self, joint: str) -> viser.FrameHandle:
        """Return the frame that a joint moves."""
        return next(f.handle for f in self._frames if f.joint.name == joint)

    def show(self, positions: Mapping[str, float]) -> None:
        """Move the joints.

        Args:
            positions: Joint positions by name [rad] or [m]; a joint without a position
                stays as it is, and unknown names are skipped.
        """
        with self._place.atomic():
            for frame in self._frames:
                q = position_among(frame.joint, positions)
                name = frame.joint.name
                if q is None or abs(q - self.shown.get(name, 9e9)) < _SMALLEST_STEP:
                    continue
                self.shown[name] = q
                pose = pose_at(frame.joint, q)
                # Viser sends every assignment, so the constant part is not assigned.
                if frame.joint.type.is_rotation:
                    frame.handle.wxyz = pose.quaternion
                else:
                    frame.handle.position = pose.xyz
