"""The joints of the last cycle."""

from station.core.loop.snapshot import SnapshotRing
from tests.api.test_errors import problem_of


def test_joint_states(client):
    states = client.joint_states()

    assert states.name == ["j"]
    assert states.position == [0.25]
    assert states.velocity == [0.0]
    assert states.effort == [0.0]
    assert states.stamp == 0.001


def test_joint_states_are_refused_before_the_first_cycle(
    operator, station, monkeypatch
):
    monkeypatch.setattr(station.loop, "snapshots", SnapshotRing())

    problem_of(operator.get("/api/v1/joint_states"), 503, "loop")
