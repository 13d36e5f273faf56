"""Events on the wire have the words of the event log."""

from typing import get_args

from station.events import EventKind, Severity
from station.wire.events import EventKindName, SeverityName


def test_kinds_and_severities_are_those_of_the_log():
    assert set(get_args(EventKindName)) == {kind.value for kind in EventKind}
    assert list(get_args(SeverityName)) == [severity.value for severity in Severity]
