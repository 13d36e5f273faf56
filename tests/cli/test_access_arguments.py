"""Options of the verbs about who did what and who may."""

import pytest

from station.cli.arguments import build_parser


def test_events_are_the_newest_of_all_kinds_unless_told():
    options = build_parser().parse_args(["events"])

    assert (options.kind, options.since, options.severity) == ([], None, "info")
    assert (options.count, options.follow) == (50, False)


def test_control_is_shown_unless_told():
    options = build_parser().parse_args(["control"])

    assert (options.action, options.ttl, options.force) == ("show", 10.0, False)


@pytest.mark.parametrize("action", ["create", "list", "revoke"])
def test_a_token_is_an_operators_unless_told(action):
    assert build_parser().parse_args(["token", action]).role == "operator"
