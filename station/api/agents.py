"""Rights of agents (programs with an agent's token), and their requests to people.

A request of an agent that can move the robot waits here until a person with the
operator role has allowed or refused it; until then nothing of it begins. No text that
an agent reads can extend its rights: the agent's token cannot change the list of its
operations or its envelope.
"""

import asyncio
import secrets
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from fastapi import Request

from station.api.auth import Access
from station.core.errors import StationError, suggest
from station.core.facade.station import Station
from station.events import EventKind, EventLog, Origin, Severity
from station.reports import AgentRequest, Verdict

FREE = frozenset([
    "stop", "stop_gripper", "cancel_goal", "cancel_playback",
    "rehearse", "plan",
    "take_control", "renew_control", "release_control",
    "start_recording", "stop_recording",
])  # fmt: skip
"""Operations that agents may call without asking: they move nothing, or end a motion.
"""
REHEARSED = frozenset([
    "put_command", "submit_goal", "follow_trajectory", "play_waypoint_path",
])  # fmt: skip
"""Commands that need the certificate of a rehearsal if the policy requires one."""
_NOT_READ = frozenset(["list_tokens", "stream_needs_websocket"])
ASKED = REHEARSED | frozenset([
    "load_controller", "unload_controller", "switch_controllers",
    "patch_gains", "patch_gains_of_controllers", "undo_gains", "apply_gain_set",
    "measure_response", "error_recovery",
    "home_gripper", "move_gripper", "grasp",
    "step",
])  # fmt: skip
"""Operations of agents that a person must allow. Agents may not call any others."""
_IN_EVENTS = ("number", "operation", "target", "request")
MOST_WAITING = 4
"""Most waiting requests of one agent: more would hide the first one from people."""
MOST_KEPT = 200
"""Most requests that are kept, including decided ones."""


def seat_of(method: str, operation: Mapping[str, Any]) -> str | None:
    """Return the agents' right to an operation; None when agents cannot use it.

    Args:
        method: HTTP method, in lower case.
        operation: The operation in the OpenAPI document.

    Returns:
        `read`; `free` (without asking); or `asked` (once a person has allowed the
        call). The document has the right as `x-agent`.
    """
    name = operation["operationId"]
    if method == "get":
        # Agents may read JSON only, no files, and no list of tokens.
        content = operation["responses"].get("200", {}).get("content", {})
        is_read = "application/json" in content and name not in _NOT_READ
        return "read" if is_read else None
    if name in FREE:
        return "free"
    return "asked" if name in ASKED else None


class AgentRefusedError(StationError, PermissionError):
    """Agents may not call the operation, or no person has allowed the request."""

    code = "agent_refused"


class TooManyAgentRequestsError(StationError, RuntimeError):
    """Too many requests of one agent wait for a person."""

    code = "too_many_agent_requests"


class AgentRequestNotFoundError(StationError, KeyError):
    """There is no request of an agent with that number."""

    code = "agent_request_not_found"


class AgentRequestDecidedError(StationError, RuntimeError):
    """A request of an agent is already decided, and cannot be decided again."""

    code = "agent_request_decided"


@dataclass(frozen=True, slots=True)
class AgentPolicy:
    """Rules of a station for its agents.

    Attributes:
        approval: Whether a person must allow each motion. False is possible only in a
            stepped simulation, in which nothing moves by itself.
        wait: How long a request waits for a person [s], > 0.
        grant: How long `ALLOWED_FOR_A_TIME` allows further requests [s].
    """

    approval: bool = True
    wait: float = 60.0
    grant: float = 600.0


@dataclass(slots=True)
class _Waiting:
    report: AgentRequest
    decided: asyncio.Event = field(default_factory=asyncio.Event)


class Agents:
    """Requests of agents, and the answers of people. Use it in one event loop only.

    Args:
        station: The station.
        log: Records each request, and the person who answered it.
        policy: Limits and approvals for agents.
        now: Wall time [s since 1970].
    """

    def __init__(
        self,
        station: Station,
        log: EventLog,
        policy: AgentPolicy,
        now: Callable[[], float] = time.time,
    ) -> None:
        self._station = station
        self._log = log
        self._policy = policy
        self._now = now
        self._requests: dict[str, _Waiting] = {}
        self._granted: dict[str, tuple[float, int]] = {}

    def requests(self) -> list[AgentRequest]:
        """Return the latest requests, oldest first; waiting ones have no verdict."""
        return [waiting.report for waiting in self._requests.values()]

    def check(self, operation: str, access: Access) -> None:
        """Refuse an operation that agents may not call.

        Raises:
            AgentRefusedError: Agents may not call the operation.
        """
        if operation not in FREE | ASKED:
            raise AgentRefusedError(
                f"The agent {access.name} may not call '{operation}'. "
                f"{suggest(operation, FREE | ASKED)}",
                remedy="Ask a person to do it.",
            )

    async def admit(self, request: Request, access: Access, origin: Origin) -> None:
        """Wait until a person allows a request; return at once if none has to.

        Args:
            request: The request; its route names the operation.
            access: Rights of the agent.
            origin: The agent, and its address.

        Raises:
            AgentRefusedError: A person refused, no person answered in time, or the
                robot was stopped meanwhile.
            TooManyAgentRequestsError: Too many requests of this agent are waiting.
        """
        operation = request.scope["route"].name
        body = await request.json() if await request.body() else {}
        # Look for a preview in this operation only: other bodies may have any content.
        is_preview = (
            operation == "switch_controllers"
            and isinstance(body, dict)
            and body.get("dry_run") is True
        )
        if operation not in ASKED or is_preview:
            return
        if not self._policy.approval:
            self._check_stepped()
            return
        until, epoch = self._granted.get(access.name, (0.0, -1))
        if until > self._now() and epoch == self._station.epoch:
            return
        target = ", ".join(request.path_params.values())
        asked = self._put(operation, target, body, access)
        self._record(asked.report, "asked", f"The agent {access.name} asks:", origin)
        await self._wait(asked, origin)

    async def _wait(self, asked: _Waiting, origin: Origin) -> None:
        epoch = self._station.epoch
        try:
            with suppress(TimeoutError):
                await asyncio.wait_for(asked.decided.wait(), self._policy.wait)
        finally:
            # The time is over, or the agent has closed the connection, so an answer
            # would allow a request that no client waits for.
            if asked.report.verdict is None:
                self._end(asked, Verdict.EXPIRED, origin)
        if self._station.epoch != epoch:
            raise _refused(
                "The robot was stopped, reset or recovered while the request waited.",
                "Look at the robot, then ask again.",
            )
        report = asked.report
        if report.verdict is Verdict.EXPIRED:
            raise _refused(
                f"Nobody answered within {self._policy.wait:g} s.",
                "Ask again when a person is at the dashboard.",
            )
        if report.verdict is Verdict.REFUSED:
            raise _refused(f"{report.decided_by} refused it.", "Ask the person why.")

    def decide(self, number: str, verdict: Verdict, origin: Origin) -> AgentRequest:
        """Allow or refuse a waiting request.

        Args:
            number: The request.
            verdict: `ALLOWED`, `ALLOWED_FOR_A_TIME` or `REFUSED`.
            origin: The person who answers.

        Raises:
            AgentRequestNotFoundError: There is no such request.
            AgentRequestDecidedError: The request is already decided, or the agent no
                longer waits.
        """
        asked = self._requests.get(number)
        if asked is None:
            raise AgentRequestNotFoundError(
                f"There is no request '{number:.80}' of an agent.",
                remedy="List them: GET /api/v1/agents/requests.",
            )
        if asked.report.verdict is not None:
            raise AgentRequestDecidedError(
                f"Request '{number}' is {asked.report.verdict} already.",
                remedy="The agent has to ask again.",
            )
        self._end(asked, verdict, origin)
        if verdict is Verdict.ALLOWED_FOR_A_TIME:
            until = self._now() + self._policy.grant
            self._granted[asked.report.agent] = (until, self._station.epoch)
        return asked.report

    def withdraw(self) -> None:
        """End all `ALLOWED_FOR_A_TIME` verdicts, because control has changed hands."""
        self._granted.clear()

    def _check_stepped(self) -> None:
        loop = self._station.loop
        if loop.advances:
            raise _refused(
                "This station lets agents move without approval, which is for a paused "
                "simulation alone; it runs.",
                "Pause the simulation and step it, or set agents.approval to 'always'.",
            )

    def _put(
        self, operation: str, target: str, body: object, access: Access
    ) -> _Waiting:
        known = [one.report for one in self._requests.values()]
        waiting = [r for r in known if r.agent == access.name and r.verdict is None]
        if len(waiting) >= MOST_WAITING:
            raise TooManyAgentRequestsError(
                f"{MOST_WAITING} requests of {access.name} wait for a person already.",
                remedy="Wait for their answers.",
            )
        now = self._now()
        number = secrets.token_hex(6)
        asked = _Waiting(
            AgentRequest(
                number=number,
                agent=access.name,
                operation=operation,
                target=target,
                request=body,
                asked_at=now,
                expires_at=now + self._policy.wait,
            )
        )
        self._requests[number] = asked
        for old, one in list(self._requests.items()):
            if len(self._requests) > MOST_KEPT and one.report.verdict is not None:
                del self._requests[old]
        return asked

    def _end(self, asked: _Waiting, verdict: Verdict, origin: Origin) -> None:
        who = "" if verdict is Verdict.EXPIRED else origin.who
        asked.report = replace(asked.report, verdict=verdict, decided_by=who)
        asked.decided.set()
        begin = f"{who or 'Nobody'} answered:"
        self._record(asked.report, verdict.value, begin, origin)

    def _record(
        self, report: AgentRequest, result: str, begin: str, origin: Origin
    ) -> None:
        self._log.record(
            EventKind.AGENT,
            f"{begin} {result}, {report.operation} {report.target}".strip() + ".",
            severity=Severity.INFO,
            what=report.agent,
            result=result,
            details={key: getattr(report, key) for key in _IN_EVENTS},
            origin=origin,
        )


def _refused(detail: str, remedy: str) -> AgentRefusedError:
    return AgentRefusedError(f"{detail} Nothing was done.", remedy=remedy)
