"""The summary of a station that a notebook shows for a client."""

import ssl
from html import escape
from typing import TypeVar

import httpx
from pydantic import ValidationError

from station.client.streams import bearer
from station.wire import Controllers, JointStates, Status
from station.wire.base import reader_of
from station.wire.protocol import PREFIX

ModelT = TypeVar("ModelT")

TIMEOUT = 1.0
"""Longest wait for the station [s]; a cell of a notebook must not hang."""


def describe(
    url: str,
    token: str | None,
    transport: httpx.BaseTransport | None = None,
    tls: ssl.SSLContext | None = None,
) -> str:
    """Return HTML of the station, its running controllers and its joints.

    Args:
        url: URL of the station.
        token: Operator or viewer token.
        transport: Transport of requests; None for httpx's own.
        tls: TLS context that checks the station's certificate; None for plain HTTP.
    """
    title = f"<b>Station</b> <a href='{escape(url)}/docs'>{escape(url)}</a>"
    try:
        with httpx.Client(
            base_url=url + PREFIX,
            headers=bearer(token),
            timeout=TIMEOUT,
            transport=transport,
            trust_env=False,
            verify=True if tls is None else tls,
        ) as http:
            status = _ask(http, "/status", Status)
            controllers = _ask(http, "/controllers", Controllers)
            joints = _ask(http, "/joint_states", JointStates)
    except (httpx.HTTPError, ValidationError) as error:
        return f"{title}: no answer ({escape(str(error))})"
    running = [c.name for c in controllers.controllers if c.state == "running"]
    facts = f"{status.robot_mode}, stop {status.stop_state}, epoch {status.epoch}"
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{_number(q)}</td><td>{_number(dq)}</td></tr>"
        for name, q, dq in zip(
            joints.name, joints.position, joints.velocity, strict=False
        )
    )
    names = escape(", ".join(running) or "nothing")
    return (
        f"{title}: {escape(facts)}<br>running: {names}"
        "<table><tr><th>joint</th><th>position</th><th>velocity</th></tr>"
        f"{rows}</table>"
    )


def _ask(http: httpx.Client, path: str, model: type[ModelT]) -> ModelT:
    return reader_of(model).validate_json(http.get(path).raise_for_status().content)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"
