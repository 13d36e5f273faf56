"""Named tokens: kept as hashes, gone when revoked or expired."""

import asyncio
import stat

import pytest

from station.api.named_tokens import (
    MOST_TOKENS,
    NamedTokens,
    TokenExistsError,
    TokenNotFoundError,
    TokensNotKeptError,
)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "tokens.json"


def test_a_token_is_known_again_after_a_restart_but_not_kept(path):
    secret = NamedTokens(path).create("ada", "operator", None)

    token = NamedTokens(path).find(secret)

    assert (token.name, token.role) == ("ada", "operator")
    assert secret not in path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert NamedTokens(path).find(secret + "x") is None


def test_a_revoked_token_is_gone_for_good(path):
    tokens = NamedTokens(path)
    secret = tokens.create("ada", "operator", None)
    held = tokens.find(secret)

    tokens.revoke("ada")

    assert held.has_ended()
    asyncio.run(asyncio.wait_for(held.wait_for_end(), 5.0))
    assert tokens.find(secret) is None
    assert NamedTokens(path).all() == []
    with pytest.raises(TokenNotFoundError):
        tokens.revoke("ada")


def test_an_expired_token_is_gone():
    tokens = NamedTokens(now=lambda: 1000.0)  # long ago
    secret = tokens.create("ada", "viewer", 60.0)

    assert tokens.find(secret) is None
    assert tokens.all() == []


@pytest.mark.parametrize("name", ["ada", "operator", "viewer"])
def test_names_are_given_once(name):
    tokens = NamedTokens()
    tokens.create("ada", "viewer", None)

    with pytest.raises(TokenExistsError):
        tokens.create(name, "viewer", None)


def test_tokens_are_limited():
    tokens = NamedTokens()
    for number in range(MOST_TOKENS):
        tokens.create(f"t{number}", "viewer", None)

    with pytest.raises(TokenExistsError):
        tokens.create("another", "viewer", None)


def test_a_disk_that_fails_makes_no_token_and_revokes_all_the_same(tmp_path):
    tokens = NamedTokens(tmp_path / "tokens.json")
    secret = tokens.create("ada", "operator", None)
    tokens._path = tmp_path / "missing" / "tokens.json"

    with pytest.raises(TokensNotKeptError):
        tokens.create("grace", "operator", None)
    with pytest.raises(TokensNotKeptError):
        tokens.revoke("ada")

    assert tokens.find(secret) is None
    assert tokens.all() == []


def test_a_damaged_file_is_told(path):
    path.write_text("{")

    with pytest.raises(TokensNotKeptError, match="cannot be read"):
        NamedTokens(path)
