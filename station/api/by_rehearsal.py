"""Commands under the policy of rehearsals, with a certificate or without."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, Query, Response

from station.api.auth import Role
from station.api.dependencies import AccessDep, ServicesDep
from station.core.ports.receipt import Receipt
from station.rehearsal.rehearsals import Policy
from station.wire.protocol import REHEARSAL_HEADER


class ByRehearsal:
    """Gives commands as the caller's policy and certificate want it. One request."""

    def __init__(
        self,
        response: Response,
        services: ServicesDep,
        access: AccessDep,
        certificate: Annotated[
            str | None,
            Query(
                max_length=64,
                examples=["9E5_mt3oyZPBL6Vy"],
                description="The certificate of a rehearsal of this command: it is "
                "refused if something that matters has changed since, and stopped if "
                "the robot leaves the rehearsed motion.",
            ),
        ] = None,
    ) -> None:
        self._response = response
        self._rehearsals = services.rehearsals
        self._is_agent = access.role is Role.AGENT
        self._certificate = certificate

    @contextmanager
    def giving(self, kind: str, **command: object) -> Iterator[Receipt | None]:
        """Give a command in the body of a `with`, which must not wait for the robot.

        Args:
            kind: Its kind, as a step of a rehearsal.
            command: Its arguments, as those of the step.
        """
        rehearsals, step = self._rehearsals, {"kind": kind, **command}
        with rehearsals.redeemed(self._certificate, step) as receipt:
            if kind != "switch":
                rehearsals.check(is_agent=self._is_agent)
            policy = rehearsals.rules.policy_of(is_agent=self._is_agent)
            if policy is Policy.ADVISE and self._certificate is None:
                self._response.headers[REHEARSAL_HEADER] = "advised"
            yield receipt


ByRehearsalDep = Annotated[ByRehearsal, Depends()]
