"""The connection of a client to its station, which returns answers as wire models."""

import asyncio
import json
import math
import ssl
import time
from collections.abc import (
    AsyncIterable,
    AsyncIterator,
    Awaitable,
    Callable,
    Coroutine,
    Iterable,
    Iterator,
    Mapping,
    Sequence,
)
from pathlib import Path
from typing import Any, Generic, TypeAlias, TypeVar
from urllib.parse import quote

import httpx
from pydantic import BaseModel, JsonValue

from station.client.errors import (
    ApiError,
    EmptyNameError,
    NotFiniteError,
    StationUnreachableError,
)
from station.client.streams import (
    CommandOptions,
    Rate,
    StreamOptions,
    bearer,
    certificates,
)
from station.wire.base import reader_of
from station.wire.protocol import CLOCK_HEADER, LEASE_HEADER, NOT_AFTER_HEADER, PREFIX

_PIECE = 2**18
"""Bytes of a file that are sent in one piece."""
_ANSWERS = 20
"""Number of answers from which the offset of the station's clock is estimated."""
Sleep: TypeAlias = Callable[[float], Awaitable[None]]
ModelT = TypeVar("ModelT")
ThingT = TypeVar("ThingT")
Query = Mapping[str, str | list[str]]


class RequestDeadline:
    """Computes the latest time, by the station's clock, at which a change may begin.

    The clocks of two machines may differ, so the station's clock is estimated from the
    times in the station's answers and the time that has passed here since. An answer
    that was read late gives too early a time, so the latest of the last estimates
    counts. Any thread may use it.

    Args:
        within: Longest time from sending a change to its begin [s], > 0.
        now: Monotonic clock [s].
    """

    def __init__(
        self, within: float, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._within = within
        self._now = now
        self._ahead: tuple[float, ...] = ()

    def hear(self, headers: Mapping[str, str]) -> None:
        """Note the station's time in the headers of an answer, if they have it."""
        station_time = headers.get(CLOCK_HEADER)
        if station_time is not None:
            self._ahead = (
                *self._ahead[1 - _ANSWERS :],
                float(station_time) - self._now(),
            )

    def headers(self) -> dict[str, str]:
        """Return the header of a change that is sent now; empty before any answer."""
        if not self._ahead:
            return {}
        # The quickest answer gives the largest difference, which is the best estimate.
        not_after = self._now() + max(self._ahead) + self._within
        return {NOT_AFTER_HEADER: f"{not_after:.3f}"}


class AsyncConnection:
    """Sends requests and reads the answers.

    Only the connection sleeps or starts tasks, so that a client without asyncio can
    replace these methods.

    Args:
        url: URL of the station, without a slash at its end.
        token: Operator or viewer token.
        timeout: Longest wait for an answer [s].
        transport: Transport of requests; None for httpx's own.
        tls: TLS context that checks the station's certificate; None for plain HTTP.

    Attributes:
        url: The station.
        token: Operator or viewer token.
        timeout: Longest wait for an answer [s]; may be changed.
        lease: The lease of control under which requests are sent; None without one.
        tls: TLS context that checks the station's certificate; None for plain HTTP.
        deadline: Computes the latest begin of changes; None lets them begin however
            late.
    """

    def __init__(
        self,
        url: str,
        token: str | None,
        timeout: float,
        transport: httpx.AsyncBaseTransport | None = None,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        self.url = url
        self.token = token
        self.timeout = timeout
        self.lease: str | None = None
        self.tls = tls
        self.deadline: RequestDeadline | None = None
        self._http = httpx.AsyncClient(
            base_url=url,
            headers=bearer(token),
            timeout=timeout,
            transport=transport,
            # Ignore proxies of the environment, which would see the token.
            trust_env=False,
            verify=certificates(tls),
        )

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def sleep(self, seconds: float) -> None:
        """Let some time pass [s]."""
        await asyncio.sleep(seconds)

    def repeat(
        self, act: Callable[[], Coroutine[Any, Any, bool]], period: float
    ) -> Callable[[], Awaitable[None]]:
        """Repeat a function in the background until it returns False.

        Args:
            act: Function to repeat, called first after a period.
            period: Time from the end of a call to the next call [s], > 0.

        Returns:
            A function that ends the repetition, and cancels or awaits a running call.
        """

        async def run() -> None:
            going_on = True
            while going_on:
                await asyncio.sleep(period)
                going_on = await act()

        task = asyncio.create_task(run())

        async def stop() -> None:
            task.cancel()
            await asyncio.wait([task])

        return stop

    def talk_to(self, url: str, token: str | None) -> None:
        """Send to another station from the next request on.

        Args:
            url: URL of the station, without a slash at its end.
            token: Operator or viewer token.
        """
        self.url, self.token, self.lease = url, token, None
        self._http.base_url = httpx.URL(url)
        # Without a token `bearer` is empty, and the old header would stay.
        self._http.headers.pop("Authorization", None)
        self._http.headers.update(bearer(token))

    def stream_options(
        self, topic: str, rate: Rate | None, fields: Sequence[str], *, reconnect: bool
    ) -> StreamOptions:
        """Return address and options of a stream.

        Args:
            topic: Topic to stream.
            rate: Frames per second [Hz], or "full"; None means the station's default.
            fields: Keys of `data` to send; all when empty.
            reconnect: Whether to connect again when the link breaks.
        """
        return StreamOptions(
            self.url,
            self.token,
            topic,
            rate,
            tuple(fields),
            reconnect,
            self.timeout,
            self._tls_of_streams(),
        )

    def command_options(self, controller: str, timeout: float) -> CommandOptions:
        """Return address and options of a stream of set-points.

        Args:
            controller: The controller.
            timeout: Silence after which the last set-point expires [s], > 0.
        """
        return CommandOptions(
            self.url,
            self.token,
            self.lease,
            controller,
            timeout,
            self.timeout,
            self._tls_of_streams(),
        )

    def _tls_of_streams(self) -> ssl.SSLContext | None:
        # A WebSocket without TLS must not get a context.
        return self.tls if self.url.startswith("https:") else None

    async def get(
        self, path: str, answer: type[ModelT], query: Query | None = None
    ) -> ModelT:
        """Send a GET request and return the answer.

        Args:
            path: Path below the prefix of the API.
            answer: Wire model of the answer.
            query: Query parameters; a list repeats its parameter.

        Raises:
            ApiError: The station refuses.
            StationUnreachableError: The station does not answer.
        """
        return await self._request("GET", path, answer, query=query)

    async def send(
        self,
        method: str,
        path: str,
        answer: type[ModelT],
        body: BaseModel | Mapping[str, JsonValue] | Path | None = None,
        *,
        headers: Mapping[str, str] | None = None,
        query: Query | None = None,
        patience: float = 0.0,
    ) -> ModelT:
        """Send a request that changes something and return the answer.

        Args:
            method: HTTP method.
            path: Path below the prefix of the API.
            answer: Wire model of the answer.
            body: JSON, a model, of which only fields with a value are sent, or a file.
            headers: Extra headers.
            query: Query parameters; a list repeats its parameter.
            patience: Extra time for the answer [s]; infinity waits for ever.

        Raises:
            ApiError: The station refuses.
            StationUnreachableError: The station does not answer.
            ValueError: A number of the body is not finite.
        """
        sent = dict(headers or {})
        if self.deadline is not None:
            sent |= self.deadline.headers()
        if self.lease is not None:
            sent[LEASE_HEADER] = self.lease
        content: bytes | AsyncIterable[bytes] | None = None
        if isinstance(body, Path):
            sent["Content-Type"] = "application/octet-stream"
            content = _pieces(body)
        elif body is not None:
            sent["Content-Type"] = "application/json"
            content = _written(body)
        return await self._request(
            method,
            path,
            answer,
            query=query,
            content=content,
            headers=sent,
            patience=patience,
        )

    async def download(
        self, path: str, target: Path, query: Query | None = None
    ) -> None:
        """Write the answer of a GET request to a new file.

        Args:
            path: Path below the prefix of the API.
            target: The file to write, which must not exist.
            query: Query parameters; a list repeats its parameter.

        Raises:
            ApiError: The station refuses; no file is made.
            StationUnreachableError: The station does not answer, or the answer ends
                early; the received part is deleted.
            FileExistsError: The file already exists.
        """
        try:
            async with self._http.stream(
                "GET", PREFIX + path, params=query
            ) as response:
                if not response.is_success:
                    body = await response.aread()
                    refusal = ApiError.from_body(response.status_code, body)
                    raise refusal
                with target.open("xb") as file:
                    async for part in response.aiter_bytes():
                        file.write(part)
        except httpx.TransportError as error:
            # An incomplete file must not be taken for a recording.
            target.unlink(missing_ok=True)
            raise StationUnreachableError(self.url, error) from error

    async def _request(
        self,
        method: str,
        path: str,
        answer: type[ModelT],
        *,
        query: Query | None = None,
        content: bytes | AsyncIterable[bytes] | None = None,
        headers: Mapping[str, str] | None = None,
        patience: float = 0.0,
    ) -> ModelT:
        # The answer to a long operation may take long, but connecting may not.
        read = self.timeout + patience if math.isfinite(patience) else None
        try:
            response = await self._http.request(
                method,
                PREFIX + path,
                params=query,
                content=content,
                headers=headers,
                timeout=httpx.Timeout(self.timeout, read=read),
            )
        except httpx.TransportError as error:
            raise StationUnreachableError(self.url, error) from error
        if self.deadline is not None:
            self.deadline.hear(response.headers)
        if not response.is_success:
            refusal = ApiError.from_body(response.status_code, response.content)
            raise refusal
        return reader_of(answer).validate_json(response.content)


class ClientPart:
    """The client of one part of the API.

    Every method raises the errors of the station client's own methods.

    Args:
        connection: The connection to the station.
    """

    _path = ""
    """Path of the part below the prefix of the API."""

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection
        self._get, self._send = connection.get, connection.send

    def _of(self, name: str, rest: str = "") -> str:
        """Return the path of a named thing, or of a part of the thing."""
        path = f"{self._path}/{segment(name)}"
        return f"{path}/{rest}" if rest else path


class NamedThings(ClientPart, Generic[ThingT]):
    """The client of a store whose things have names."""

    _kind: type[ThingT]

    async def get(self, name: str) -> ThingT:
        """Return the thing of that name."""
        return await self._get(self._of(name), self._kind)

    async def delete(self, name: str) -> ThingT:
        """Delete the thing of that name, and return it."""
        return await self._send("DELETE", self._of(name), self._kind)


async def _pieces(path: Path) -> AsyncIterator[bytes]:
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            yield piece


def _written(body: BaseModel | Mapping[str, JsonValue]) -> bytes:
    if isinstance(body, BaseModel):
        # Leave defaults to the station: an older client must not fix them.
        return body.model_dump_json(exclude_unset=True).encode()
    try:
        return json.dumps(dict(body), allow_nan=False).encode()
    except ValueError as error:
        for field, value in _numbers(body):
            if not math.isfinite(value):
                raise NotFiniteError(field, value) from error
        raise


def _numbers(value: object, path: str = "") -> Iterator[tuple[str, float]]:
    """Return the fields of a body that are floating-point numbers."""
    if isinstance(value, float):
        yield path, value
        return
    items: Iterable[tuple[object, object]] = ()
    if isinstance(value, Mapping):
        items = value.items()
    elif isinstance(value, Sequence) and not isinstance(value, str):
        items = enumerate(value)
    for key, each in items:
        yield from _numbers(each, f"{path}/{key}" if path else str(key))


def segment(name: str) -> str:
    """Return `name` as one segment of a path.

    Raises:
        EmptyNameError: The name is empty, so that the path would be another one.
    """
    if not name:
        raise EmptyNameError
    # Slashes in a name are not separators of the path, and dots do not lead upwards.
    quoted = quote(name, safe="")
    return quoted if quoted.strip(".") else quoted.replace(".", "%2E")
