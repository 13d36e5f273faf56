"""Verbs about rights: `control`, `token`, `agents` for their requests, and `mcp`."""

import asyncio
import json
import os
import secrets
import signal
import subprocess
import sys
import time
from argparse import Namespace
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn

from station.cli.connection import LEASE_VARIABLE, locate, open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table, say
from station.cli.parser import check_words
from station.core.installation import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import ControlState, NewToken

    Verdict = Literal["allowed", "allowed_for_a_time", "refused"]

LOOK_PERIOD = 0.2
"""Time between two checks whether control was lost [s]."""
_CONTROL = {"show": "", "take": "owner ttl force", "release": ""}
_TOKEN = {"create": "name role expires", "list": "", "revoke": "name"}
VERDICTS: "Mapping[str, Verdict]" = {
    "allow": "allowed",
    "allow-for-10-min": "allowed_for_a_time",
    "refuse": "refused",
}


def add_control(parser: "Parser") -> None:
    """Add the arguments of `control`."""
    add = parser.add_argument
    add("action", nargs="?", choices=("show", "take", "release"), default="show")
    add("--owner", metavar="NAME", help="name that others are told")
    add("--ttl", type=float, default=10.0, metavar="S", help="longest silence [s]")
    add("--force", action="store_true", help="take it from whoever holds it")


def add_token(parser: "Parser") -> None:
    """Add the arguments of `token`."""
    add = parser.add_argument
    add("action", choices=("create", "list", "revoke"))
    add("name", nargs="?", metavar="NAME", help="whose token")
    add("--role", choices=("operator", "viewer", "agent"), default="operator")
    add("--expires", type=float, metavar="S", help="how long it is valid [s]")


def control(options: Namespace) -> int:
    """Show the holder of control, take control until Ctrl-C, or give it back."""
    check_words(options, _CONTROL)
    with open_client(options) as client:
        if options.action == "take":
            _take(client, options)
        elif options.action == "release":
            client.lease.release()
            answer(options, {"owner": None}, "Control is given back.")
        else:
            _show(client.lease.state(), options)
    return 0


def _take(client: "StationClient", options: Namespace) -> None:
    with client.control(options.owner, ttl=options.ttl, force=options.force) as lease:
        state = lease.renew()
        _show(state, options)
        if not options.json:
            say("Ctrl-C gives it back. Other shells act under this lease with")
            say(f"export {LEASE_VARIABLE}={state.lease}")
        sys.stdout.flush()
        while lease.lost is None:
            time.sleep(LOOK_PERIOD)
        raise lease.lost


def _show(state: "ControlState", options: Namespace) -> None:
    line = "Nobody holds control; every operator may change things."
    if state.owner is not None:
        offer = f" It is offered to {state.hand_over_to}." if state.hand_over_to else ""
        line = f"{state.owner} holds control since {_time(state.since)}.{offer}"
    answer(options, state, line)


def token(options: Namespace) -> int:
    """Make, list or revoke named tokens.

    Raises:
        UsageError: `create` or `revoke` was given without a name.
    """
    check_words(options, _TOKEN)
    if options.action != "list" and options.name is None:
        raise UsageError(
            f"Whose token? `{options.action}` needs a name.",
            remedy=f"station token {options.action} NAME",
        )
    with open_client(options) as client:
        if options.action == "list":
            found = client.tokens.list()
            rows = [(t.name, t.role, _time(t.expires_at)) for t in found]
            return answer_table(options, found, ("name", "role", "expires"), rows)
        if options.action == "create":
            made = client.tokens.create(
                options.name, options.role, expires=options.expires
            )
            return answer(options, made, made.token)
        gone = client.tokens.revoke(options.name)
    return answer(options, gone, f"{gone.name} has no token now.")


def _time(stamp: float | None) -> str:
    if stamp is None:
        return "never"
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(stamp))


def add_agents(parser: "Parser") -> None:
    """Add the arguments of `agents`."""
    add = parser.add_argument
    add("action", nargs="?", choices=("list", *VERDICTS), default="list")
    add("number", nargs="?", metavar="NUMBER", help="which request")


def agents(options: Namespace) -> int:
    """List the requests of agents, or answer one.

    Raises:
        UsageError: An answer was given without the number of a request.
    """
    check_words(options, {"list": "", **dict.fromkeys(VERDICTS, "number")})
    if options.action != "list" and options.number is None:
        raise UsageError(
            "Which request? An answer needs its number.", remedy="station agents list"
        )
    with open_client(options) as client:
        if options.action != "list":
            answered = client.agents.answer(options.number, VERDICTS[options.action])
            return answer(options, answered, f"It is {answered.verdict}.")
        found = client.agents.requests()
    rows = [
        (
            r.number,
            r.agent,
            r.operation,
            r.target,
            r.verdict or "waits",
            _shown(r.request),
        )
        for r in found
    ]
    headers = ("number", "agent", "operation", "target", "verdict", "request")
    return answer_table(options, found, headers, rows)


def _shown(request: object) -> str:
    text = json.dumps(request)
    return text if len(text) <= 200 else f"{text[:180]}… (whole with --json)"


def add_mcp(parser: "Parser") -> None:
    """Add the arguments of `mcp`."""
    add = parser.add_argument
    add("--name", metavar="NAME", help="name of the agent, for people and events")
    add("--journal", metavar="FILE", type=Path, help="write every call to this file")
    add(
        "--replay",
        metavar="FILE",
        type=Path,
        help="make the calls of a journal again, print the answers, and end",
    )


def mcp(options: Namespace) -> int:
    """Serve an agent over stdin and stdout, with an agent's token.

    Raises:
        MissingExtraError: The library of the protocol is not installed.
    """
    if find_spec("mcp") is None:
        raise MissingExtraError("mcp")
    from station.mcp.server import serve

    with _own_token(options) as (url, token):
        if options.replay is None:
            asyncio.run(serve(url, token, options.ca, options.journal))
            return 0
        return asyncio.run(_replay(url, token, options))


async def _replay(url: str, token: str, options: Namespace) -> int:
    from station.mcp.server import replay

    refused = 0
    async for tool, is_refused, text in replay(url, token, options.ca, options.replay):
        refused += is_refused
        say(f"{tool}: {text}")
    return 1 if refused else 0


@contextmanager
def _own_token(options: Namespace) -> "Iterator[tuple[str, str]]":
    """Yield the address of the station, and a token of the role `agent`.

    It uses an agent's token as it is. With an operator's token it makes an agent's
    token for the time of the body, so that the agent never has the operator's rights.
    """
    url, token = locate(options.url, options.token)
    options.url, options.token = url, token
    with open_client(options) as client:
        role = client.session().role
        if role == "agent" and token is not None:
            yield url, token
            return
        name, made = _made_token(client, options.name)
        sys.stderr.write(f"The agent is called {name}.\n")
        heir = _start_heir(url, token, options.ca, name)

        def revoke() -> None:
            client.tokens.revoke(name)
            heir.kill()

        def end(number: int, _: object) -> NoReturn:
            # The loop would wait for its thread that reads stdin, perhaps for ever.
            revoke()
            os._exit(128 + number)

        before = signal.signal(signal.SIGTERM, end)
        try:
            # After an exception the heir revokes the token: its input ends here.
            with heir:
                yield url, made.token
                revoke()
        finally:
            signal.signal(signal.SIGTERM, before)


def _start_heir(
    url: str, token: str | None, ca: str | None, name: str
) -> "subprocess.Popen[bytes]":
    """Start a process that revokes an agent's token if this process is killed.

    A host may kill its server, which then can revoke nothing, and the token would stay
    valid for whoever has seen it.
    """
    known = {"STATION_URL": url, "STATION_TOKEN": token, "STATION_CA": ca}
    given = {key: value for key, value in known.items() if value is not None}
    revoke = [sys.executable, "-m", "station", "token", "revoke", name]
    return subprocess.Popen(
        # The input of the shell ends with this process, however it ends.
        ["sh", "-c", 'read -r _; exec "$@"', "sh", *revoke],
        env=os.environ | given,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def _made_token(client: "StationClient", wanted: str | None) -> "tuple[str, NewToken]":
    """Make a token of the role `agent`; return the agent's name and the token.

    If the name is taken, the agent gets a similar one: a host may start its server
    twice, and a server that is killed leaves its token behind.

    Raises:
        ApiError: There are too many tokens, or the client may not make any.
    """
    unique = f"{wanted or 'agent'}-{secrets.token_hex(2)}"
    from station.client import ApiError

    if wanted is not None:
        try:
            return wanted, client.tokens.create(wanted, "agent")
        except ApiError as error:
            if error.code != "token_exists":
                raise
    return unique, client.tokens.create(unique, "agent")
