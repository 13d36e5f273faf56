"""Frames that follow joints."""

import pytest

from station.core.description.urdf_parser import parse_urdf
from station.ui.scene.joint_frames import MovingFrame, MovingFrames

ROBOT = """<robot name="r"><link name="base"/><link name="slide"/>
<joint name="rail" type="prismatic"><parent link="base"/><child link="slide"/>
<axis xyz="0 1 0"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>
</robot>"""


def _handle(frames, joint):
    """Return the frame that a joint moves."""
    return next(f.handle for f in frames.frames if f.joint.name == joint)


@pytest.fixture
def frames(shared_bench):
    server = shared_bench.guarded.server
    handle = server.scene.add_frame("/slide")
    joint = parse_urdf(ROBOT).joints["rail"]
    yield MovingFrames(server, [MovingFrame(joint, handle)])
    handle.remove()


def test_a_slide_moves_along_its_axis(frames):
    frames.show({"rail": 0.25, "unknown": 1.0})
    assert tuple(_handle(frames, "rail").position) == (0.0, 0.25, 0.0)
    assert frames.shown == {"rail": 0.25}


def test_a_joint_without_position_stays(frames):
    frames.show({"rail": 0.25})
    frames.show({})
    assert tuple(_handle(frames, "rail").position) == (0.0, 0.25, 0.0)
