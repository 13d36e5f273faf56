"""Verb `token`."""

import json


def test_a_token_is_made_and_printed_once(run, station):
    assert run("token create ada --role viewer --expires 60").out == "secret\n"
    assert station.calls == [("create", "ada", "viewer", 60.0)]


def test_tokens_are_listed_without_their_secret(run):
    assert "ada" in run("token list").out
    (token,) = json.loads(run("token list --json").out)
    assert "token" not in token


def test_a_token_is_revoked(run, station):
    run("token revoke ada")

    assert station.calls == [("revoke", "ada")]


def test_a_name_is_needed(run):
    assert run("token create").code == 2
