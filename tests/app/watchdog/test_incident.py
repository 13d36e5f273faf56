"""Incident files: whole at any time, private, and not too many."""

import json
import os
import stat
from pathlib import Path

from station.app.watchdog.watch import KEPT, Incident


def test_the_file_has_the_facts_and_those_that_are_added(tmp_path):
    incident = Incident(str(tmp_path / "new"), 4711, {"what": "it hung"})
    incident.add(recovered_after=0.5)

    facts = json.loads(Path(incident.path).read_text())

    assert (facts["station_pid"], facts["what"]) == (4711, "it hung")
    assert facts["recovered_after"] == 0.5
    assert stat.S_IMODE(os.stat(incident.path).st_mode) == 0o600
    assert [p.suffix for p in (tmp_path / "new").iterdir()] == [".json"]


def test_the_oldest_files_go(tmp_path):
    for number in range(KEPT + 5):
        (tmp_path / f"20000101T000000-{number:03}.json").write_text("{}")

    incident = Incident(str(tmp_path), 1, {})

    names = sorted(path.name for path in tmp_path.iterdir())
    assert len(names) == KEPT
    assert names[0] == "20000101T000000-006.json"
    assert os.path.basename(incident.path) == names[-1]


def test_a_file_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "taken").write_text("")

    incident = Incident(str(tmp_path / "taken"), 1, {"what": "it hung"})

    assert incident.failure is not None
    assert incident.facts["what"] == "it hung"
