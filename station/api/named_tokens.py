"""Tokens of people and programs, which have names, can be revoked, and may expire.

Disk and memory hold only the SHA-256 of each token. A token has 256 random bits, so it
cannot be guessed from its hash, which needs no salt.
"""

import asyncio
import contextlib
import hashlib
import json
import os
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import anyio.to_thread

from station.core.errors import StationError, suggest
from station.core.user_files import read_regular

MOST_TOKENS = 256
"""Most named tokens of a station."""
_LARGEST = 1_000_000
"""Largest file of tokens that is read [bytes]."""
LOOK_PERIOD = 1.0
"""Longest time between two checks whether a token has expired [s]."""
RESERVED = frozenset({"operator", "viewer"})
"""Names of the tokens that the station makes itself."""


class TokenExistsError(StationError, ValueError):
    """There is already a token of that name, or there are too many tokens."""

    code = "token_exists"


class TokenNotFoundError(StationError, KeyError):
    """There is no token of that name."""

    code = "token_not_found"


class TokensNotKeptError(StationError, OSError):
    """The named tokens cannot be written to disk."""

    code = "tokens_not_kept"


@dataclass(eq=False, slots=True)
class NamedToken:
    """A token as the station keeps it. Use it in one event loop only.

    Attributes:
        name: Owner of the token.
        role: `operator`, `viewer` or `agent`.
        digest: SHA-256 of the token, hexadecimal.
        created: Wall time when it was made [s since 1970].
        expires: Wall time when it expires [s since 1970]; None if it does not expire.
    """

    name: str
    role: str
    digest: str
    created: float
    expires: float | None = None
    _revoked: asyncio.Event = field(default_factory=asyncio.Event)

    def has_ended(self) -> bool:
        """Return whether the token was revoked or has expired."""
        expired = self.expires is not None and time.time() >= self.expires
        return expired or self._revoked.is_set()

    def revoke(self) -> None:
        """End the token, its sessions and its streams."""
        self._revoked.set()

    async def wait_for_end(self) -> None:
        """Wait until the token is revoked or has expired."""
        while not self.has_ended():
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._revoked.wait(), LOOK_PERIOD)


class NamedTokens:
    """The named tokens of a station. Use it in one event loop only.

    Args:
        path: File of the tokens, readable by the station's user only; None keeps them
            until the station ends.
        now: Wall time [s since 1970].

    Raises:
        TokensNotKeptError: The file exists but cannot be read.
    """

    def __init__(
        self, path: Path | None = None, now: Callable[[], float] = time.time
    ) -> None:
        self._path = path
        self._now = now
        self._tokens: dict[str, NamedToken] = {}
        self._changing = asyncio.Lock()  # one change at a time
        if path is not None and path.exists():
            self._load(path)

    def all(self) -> list[NamedToken]:
        """Return the valid tokens, oldest first."""
        self._forget_ended()
        return list(self._tokens.values())

    def by_digest(self) -> dict[str, NamedToken]:
        """Return the valid tokens by their SHA-256. Any thread."""
        found = list(self._tokens.values())
        return {token.digest: token for token in found if not token.has_ended()}

    def find(self, secret: str) -> NamedToken | None:
        """Return the valid token of a secret; None if there is none."""
        # The time to compare hashes of secrets tells nothing about a secret.
        digest = hashlib.sha256(secret.encode()).hexdigest()
        for token in self._tokens.values():
            if token.digest == digest:
                return None if token.has_ended() else token
        return None

    async def create(self, name: str, role: str, lifetime: float | None) -> str:
        """Make a token and return it; the station keeps only its hash.

        Args:
            name: Owner of the token.
            role: `operator`, `viewer` or `agent`.
            lifetime: How long it is valid [s], > 0; None until it is revoked.

        Raises:
            TokenExistsError: The name is taken, or there are too many tokens.
            TokensNotKeptError: The token cannot be written to disk; no token is made.
        """
        async with self._changing:
            return await self._create(name, role, lifetime)

    async def _create(self, name: str, role: str, lifetime: float | None) -> str:
        self._forget_ended()
        if name in self._tokens or name in RESERVED:
            raise TokenExistsError(
                f"There is a token named '{name}' already.",
                remedy="Revoke it first, or choose another name.",
                details={"name": name},
            )
        if len(self._tokens) >= MOST_TOKENS:
            raise TokenExistsError(
                f"There are {MOST_TOKENS} named tokens, which is the most allowed.",
                remedy="Revoke those that nobody needs.",
            )
        secret = secrets.token_urlsafe(32)
        created = self._now()
        token = NamedToken(
            name,
            role,
            hashlib.sha256(secret.encode()).hexdigest(),
            created,
            None if lifetime is None else created + lifetime,
        )
        await self._keep({**self._tokens, name: token})
        return secret

    def get(self, name: str) -> NamedToken:
        """Return a valid token.

        Raises:
            TokenNotFoundError: No valid token has this name.
        """
        self._forget_ended()
        if name not in self._tokens:
            raise TokenNotFoundError(
                f"There is no named token '{name}'. {suggest(name, self._tokens)}",
                remedy="List the tokens.",
                details={"name": name},
            )
        return self._tokens[name]

    async def revoke(self, name: str) -> NamedToken:
        """End a token, its sessions and its streams; return its last state.

        The token ends even if the disk fails, but is then valid again after the next
        start.

        Raises:
            TokenNotFoundError: No valid token has this name.
            TokensNotKeptError: The file could not be written, and still has the token.
        """
        # Revoke the token first: a slow disk must not keep it valid.
        token = self.get(name)
        token.revoke()
        async with self._changing:
            rest = {key: t for key, t in self._tokens.items() if key != name}
            await self._keep(rest)
        return token

    def _forget_ended(self) -> None:
        for name, token in list(self._tokens.items()):
            if token.has_ended():
                del self._tokens[name]

    async def _keep(self, tokens: dict[str, NamedToken]) -> None:
        if self._path is not None:
            listed = [
                {
                    "name": token.name,
                    "role": token.role,
                    "digest": token.digest,
                    "created": token.created,
                    "expires": token.expires,
                }
                for token in tokens.values()
            ]
            try:
                # A disk may take seconds, so write in a thread while the event loop
                # goes on.
                await anyio.to_thread.run_sync(
                    _write_whole, self._path, json.dumps(listed)
                )
            except OSError as error:
                raise TokensNotKeptError(
                    f"{self._path} cannot be written: {error.strerror}.",
                    remedy="Make room on the disk, or set XDG_STATE_HOME to a "
                    "directory that is yours, and try again.",
                ) from error
        self._tokens = tokens

    def _load(self, path: Path) -> None:
        try:
            listed = json.loads(read_regular(path, _LARGEST))
            found = [NamedToken(**values) for values in listed]
        except (OSError, ValueError, TypeError) as error:
            raise TokensNotKeptError(
                f"{path} cannot be read: {error}.",
                remedy="Delete the file; the named tokens in it are lost.",
            ) from error
        self._tokens = {token.name: token for token in found}
        self._forget_ended()


def _write_whole(path: Path, text: str) -> None:
    """Write a private file, so that at any moment the old or the new one exists."""
    beside = path.with_name(f"{path.name}.new")
    beside.unlink(missing_ok=True)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    with os.fdopen(os.open(beside, flags, 0o600), "w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)
