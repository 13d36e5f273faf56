"""What an event keeps of what it is told."""

import json

from station.events.event_file import MAX_DETAILS, written_details
from station.reports import EventKind, Severity


def test_severities_have_an_order():
    assert Severity.INFO.rank < Severity.WARNING.rank < Severity.ERROR.rank


def test_details_become_json_whatever_they_are():
    details = {"kind": EventKind.STOP, "x": float("nan"), "set": {1}, "p": object}

    found = json.loads(written_details(details))

    assert found == {"kind": "stop", "x": None, "set": [1], "p": str(object)}


def test_long_details_are_shortened():
    text = written_details({"traceback": "x" * 10 * MAX_DETAILS})

    assert len(text) <= MAX_DETAILS
    assert list(json.loads(text)) == ["shortened"]
