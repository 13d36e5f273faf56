"""Named tokens: kept as hashes, gone when revoked or expired."""

import asyncio
import stat
import threading

import pytest

from station.api import named_tokens
from station.api.named_tokens import (
    MOST_TOKENS,
    NamedTokens,
    TokenExistsError,
    TokenNotFoundError,
    TokensNotKeptError,
)
from tests.waiting import PATIENCE


@pytest.fixture
def path(tmp_path):
    return tmp_path / "tokens.json"


def test_a_token_is_known_again_after_a_restart_but_not_kept(path):
    secret = asyncio.run(NamedTokens(path).create("ada", "operator", None))

    token = NamedTokens(path).find(secret)

    assert (token.name, token.role) == ("ada", "operator")
    assert secret not in path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert NamedTokens(path).find(secret + "x") is None


def test_a_revoked_token_is_gone_for_good(path):
    tokens = NamedTokens(path)
    secret = asyncio.run(tokens.create("ada", "operator", None))
    held = tokens.find(secret)

    asyncio.run(tokens.revoke("ada"))

    assert held.has_ended()
    asyncio.run(asyncio.wait_for(held.wait_for_end(), PATIENCE))
    assert tokens.find(secret) is None
    assert NamedTokens(path).all() == []
    with pytest.raises(TokenNotFoundError):
        asyncio.run(tokens.revoke("ada"))


def test_an_expired_token_is_gone():
    tokens = NamedTokens(now=lambda: 1000.0)  # long ago
    secret = asyncio.run(tokens.create("ada", "viewer", 60.0))

    assert tokens.find(secret) is None
    assert tokens.all() == []


@pytest.mark.parametrize("name", ["ada", "operator", "viewer"])
def test_names_are_given_once(name):
    tokens = NamedTokens()
    asyncio.run(tokens.create("ada", "viewer", None))

    with pytest.raises(TokenExistsError):
        asyncio.run(tokens.create(name, "viewer", None))


def test_tokens_are_limited():
    tokens = NamedTokens()
    for number in range(MOST_TOKENS):
        asyncio.run(tokens.create(f"t{number}", "viewer", None))

    with pytest.raises(TokenExistsError):
        asyncio.run(tokens.create("another", "viewer", None))


def test_a_disk_that_fails_makes_no_token_and_revokes_all_the_same(tmp_path):
    tokens = NamedTokens(tmp_path / "tokens.json")
    secret = asyncio.run(tokens.create("ada", "operator", None))
    tokens._path = tmp_path / "missing" / "tokens.json"

    with pytest.raises(TokensNotKeptError):
        asyncio.run(tokens.create("grace", "operator", None))
    with pytest.raises(TokensNotKeptError):
        asyncio.run(tokens.revoke("ada"))

    assert tokens.find(secret) is None
    assert tokens.all() == []


def test_the_event_loop_goes_on_while_the_disk_is_slow(path, monkeypatch):
    tokens = NamedTokens(path)
    went_on = threading.Event()

    def write_when_the_loop_went_on(*_):
        assert went_on.wait(PATIENCE), "the event loop waits for the disk"

    monkeypatch.setattr(named_tokens, "_write_whole", write_when_the_loop_went_on)

    async def create_and_go_on():
        created = asyncio.create_task(tokens.create("ada", "viewer", None))
        await asyncio.sleep(0)
        went_on.set()
        return await created

    secret = asyncio.run(create_and_go_on())

    assert tokens.find(secret).name == "ada"


def test_changes_at_the_same_time_keep_each_other(path):
    tokens = NamedTokens(path)

    async def change():
        await tokens.create("old", "viewer", None)
        await asyncio.gather(
            tokens.create("ada", "viewer", None),
            tokens.revoke("old"),
            tokens.create("grace", "viewer", None),
        )

    asyncio.run(change())

    assert [token.name for token in NamedTokens(path).all()] == ["ada", "grace"]


def test_a_damaged_file_is_told(path):
    path.write_text("{")

    with pytest.raises(TokensNotKeptError, match="cannot be read"):
        NamedTokens(path)
