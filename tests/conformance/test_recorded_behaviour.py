"""The station's manager answers, calls and ends like the recorded original."""

from station.testing import RecordedBehaviour
from station.testing.recorded.deliberate_differences import DIFFERENCES


class TestOurManager(RecordedBehaviour):
    """The suite, over the manager of the station."""


def test_every_difference_has_its_reason():
    assert all(reason.endswith(".") for reason in DIFFERENCES.values())
