"""Remedies at a terminal: verbs in place of routes."""

import re

import pytest

from station.api.errors import ROUTES, STATUS
from station.cli.errors import REMEDIES, for_terminal
from station.cli.parser import parse

WITHOUT_VERB = {"goal_not_found", "loop", "plot_layout_not_found", "stale_epoch"}
WITHOUT_VERB |= {"waypoint_path_not_found"}


def test_every_hint_at_a_route_becomes_a_verb():
    assert set(ROUTES) - set(REMEDIES) == WITHOUT_VERB

    for code, hint in ROUTES.items():
        told = for_terminal(code, f"Choose another one. {hint}")
        assert told == " ".join([
            "Choose another one.",
            *REMEDIES.get(code, "").split(),
        ])


@pytest.mark.parametrize(
    "line", re.findall(r"`station ([^`]+)`", " ".join(REMEDIES.values()))
)
def test_the_verbs_exist(line, capsys):
    try:
        parse(line.split())
    except SystemExit:
        # A name is still to be given; the verb and its actions are known.
        told = capsys.readouterr().err
        assert "arguments are required" in told, told


def test_the_codes_exist():
    assert set(REMEDIES) - {"no_sample"} <= {kind.code for kind in STATUS}


@pytest.mark.parametrize(
    ("remedy", "told"),
    [
        ("", ""),
        ("Send fewer.", "Send fewer."),
        ("Recover it (POST /robots/panda/error_recovery).", "Recover it."),
        ("List them: GET /api/v1/agents/requests.", "List them."),
        ("Wait. See GET /status for a stop.", "Wait."),
    ],
)
def test_sentences_about_routes_are_left_out(remedy, told):
    assert for_terminal("other", remedy) == told
