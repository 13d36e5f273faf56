"""The newest cycle as channels: one stamp, one cycle."""

from itertools import count
from math import atan2

import pytest

from station.api.foxglove.live_channels import LiveChannels
from station.core.control.switching import SwitchRequest
from station.core.description.urdf_parser import parse_urdf
from station.records import messages
from tests.two_joint_station import make_station

URDF = """<robot name="r"><link name="base"/><link name="tip"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="tip"/>
<axis xyz="0 0 1"/></joint></robot>"""


@pytest.fixture
def station():
    """Return a station that moves."""
    station = make_station()
    station.loop.step()
    station.switch_controllers(SwitchRequest(start=("group",)))
    return station


def test_transforms_are_of_the_cycle_of_their_stamp(station, monkeypatch):
    channels = LiveChannels(station, parse_urdf(URDF))
    unpack, steps = channels._packer.unpack, count(1)

    def unpack_late(row):
        # The robot moves on while a reader computes.
        station.motion.set_command("group", [0.01 * next(steps), 0.0])
        station.loop.step(3)
        return unpack(row)

    monkeypatch.setattr(channels._packer, "unpack", unpack_late)
    angles = set()
    for _ in range(20):
        found = {m.topic: m for m in channels.newest({"/tf", "/joint_states"})}
        state = messages.JOINT_STATE.decode(found["/joint_states"].data)
        (transform,) = messages.TF_MESSAGE.decode(found["/tf"].data)["transforms"]
        rotation = transform["transform"]["rotation"]
        angle = 2.0 * atan2(rotation["z"], rotation["w"])

        assert found["/tf"].stamp == found["/joint_states"].stamp
        assert transform["header"] == {**state["header"], "frame_id": "base"}
        assert angle == pytest.approx(state["position"][0], abs=1e-12)
        angles.add(angle)
    assert len(angles) > 10


def test_a_cycle_is_sent_once(station):
    channels = LiveChannels(station)
    assert channels.newest({"/cycles"})
    assert channels.newest({"/cycles"}) == []
    station.loop.step()
    assert [m.topic for m in channels.newest({"/cycles"})] == ["/cycles"]
    assert channels.text("/nothing") is None
