"""The rehearsals of a station, in a copy of it; their certificates and policies."""

import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from station.core.errors import RehearsalError, RehearsalNeededError
from station.core.ports.receipt import Receipt
from station.rehearsal.certificates import Certificates, Tolerances
from station.rehearsal.process_copy import run_in_copy
from station.rehearsal.run_ahead import Plans, Script, run_ahead
from station.reports import Rehearsal, RehearsalOutcome

if TYPE_CHECKING:
    from station.core.facade.station import Station

_redeemed: ContextVar[bool] = ContextVar("redeemed", default=False)
"""Whether the command that is being given has the certificate of a rehearsal."""


class Policy(StrEnum):
    """Need of a rehearsal before a motion."""

    OFF = "off"
    """They need not be."""
    ADVISE = "advise"
    """They should be: the answer to a command without a certificate says so."""
    REQUIRED = "required"
    """A command without a certificate is refused."""


@dataclass(frozen=True, slots=True)
class Rules:
    """The policies of a station.

    Attributes:
        operator: For people, and for every token that is not an agent's.
        agent: For the named tokens of programs that decide by themselves.
        agents: Names of these tokens.
        tolerances: How far the robot may be from what was rehearsed.
    """

    operator: Policy = Policy.OFF
    agent: Policy = Policy.REQUIRED
    agents: frozenset[str] = frozenset()
    tolerances: Tolerances = field(default_factory=Tolerances)

    def policy_of(self, token: str | None) -> Policy:
        """Return the policy for the bearer of a named token; None has no name."""
        return self.agent if token in self.agents else self.operator


class Rehearsals:
    """Rehearses commands, and lets them be given as they were rehearsed. Any thread.

    Args:
        station: The station.
        plans: Makes inputs of further kinds of steps, by kind.
        rules: The policies.

    Attributes:
        rules: The policies.
    """

    def __init__(
        self,
        station: "Station",
        plans: Plans | None = None,
        rules: Rules | None = None,
    ) -> None:
        self.rules = rules or Rules()
        self._station = station
        self._plans = plans or {}
        self._certificates = Certificates(station, self.rules.tolerances)
        self._busy = threading.Lock()

    def adopt(self, rules: Rules) -> None:
        """Follow other rules; certificates of before are void."""
        self.rules = rules
        self._certificates = Certificates(self._station, rules.tolerances)

    def rehearse(
        self,
        steps: Sequence[Mapping[str, Any]],
        seconds: float | None = None,
        *,
        certify: bool = False,
    ) -> Rehearsal:
        """Carry steps out in a copy of the station; nothing moves.

        Args:
            steps: Inputs with `kind`, their arguments, and `at`, the time at which they
                are carried out [s since the beginning].
            seconds: How long the rehearsal lasts [s]; until the goals have ended and
                the joints stand still when None, 30 s at most.
            certify: Whether a certificate is wanted.

        Raises:
            RehearsalError: The robot is no simulated one, another rehearsal is under
                way, or this machine cannot copy the station.
        """
        if self._station.loop.hw.simulated_world() is None:
            raise RehearsalError(
                "A real robot cannot be copied.",
                remedy="Rehearse on a simulated station with the same configuration.",
            )
        if not self._busy.acquire(timeout=1.0):
            raise RehearsalError(
                "Another rehearsal is under way.", remedy="Try again in a moment."
            )
        begun = time.perf_counter()
        script = Script(steps, seconds)
        try:
            found = run_in_copy(
                lambda tell: run_ahead(self._station, script, self._plans, tell),
                self._station.loop.wait_between_cycles,
            )
        finally:
            self._busy.release()
        told = replace(found.rehearsal, wall_time=time.perf_counter() - begun)
        if certify and told.outcome is RehearsalOutcome.COMPLETED:
            issue = self._certificates.issue
            certificate = issue(steps, found.conditions, found.positions)
            told = replace(told, certificate=certificate)
        return told

    @contextmanager
    def redeemed(
        self, certificate: str | None, command: Mapping[str, Any]
    ) -> Iterator[Receipt | None]:
        """Give a command in the body of a `with`, by a certificate if there is one.

        Args:
            certificate: Name of the certificate; None without one.
            command: The command, as a step of a rehearsal.

        Raises:
            CertificateNotFoundError: There is no such certificate, or no longer.
            CertificateVoidError: It is for another command, or something that matters
                has changed; nothing moves.
            LoopError: The loop died or hangs.
        """
        if certificate is None:
            yield None
            return
        with self._certificates.redeem(certificate, command) as receipt:
            before = _redeemed.set(True)
            try:
                yield receipt
            finally:
                _redeemed.reset(before)

    def check(self, token: str | None) -> None:
        """Refuse a motion that has to be rehearsed and has no certificate.

        Args:
            token: Name of the caller's named token; None without one.

        Raises:
            RehearsalNeededError: The caller's policy requires a rehearsal.
        """
        if self.rules.policy_of(token) is Policy.REQUIRED and not _redeemed.get():
            raise RehearsalNeededError(
                f"The token '{token}' may move the robot only as it was rehearsed."
                if token
                else "The robot may be moved only as it was rehearsed.",
                remedy="Rehearse the command with `certificate: true`, and give it "
                "with the certificate of the answer.",
            )
