"""Verb `fetch_robot`: where the Panda's description is."""

import json
from pathlib import Path


def test_directory_is_printed(run, monkeypatch):
    def fetch(tell):
        tell("Fetching.")
        return Path("/data/panda")

    monkeypatch.setattr("station.cli.verbs.robot_data.fetch_panda", fetch)

    outcome = run("fetch-robot")

    assert (outcome.code, outcome.out) == (0, "/data/panda\n")
    assert outcome.err == "Fetching.\n"
    assert json.loads(run("fetch_robot --json").out) == {"directory": "/data/panda"}
