"""Rehearsals: forecasts of commands, and certificates for rehearsed commands."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Annotated

from fastapi import Depends, Query, Response

from station.api.auth import Role
from station.api.dependencies import AccessDep, OperatorAnyway, ServicesDep
from station.api.routes.routing import change, problems, routes_of
from station.core.ports.command_ticket import CommandTicket
from station.rehearsal.planning import Wish
from station.rehearsal.rehearsals import Policy
from station.reports import Plan, Rehearsal
from station.wire.protocol import REHEARSAL_HEADER
from station.wire.rehearsal import PlanRequest, RehearsalRequest

router = routes_of("rehearsals")


# A rehearsal needs no control of the station: it moves nothing, and a person who
# rehearses an agent's request must not take control from the agent.
@router.post(
    "/rehearse",
    dependencies=[OperatorAnyway],
    responses=problems(413, 422, 429, 503),
)
def rehearse(
    request: RehearsalRequest, services: ServicesDep, access: AccessDep
) -> Rehearsal:
    """Forecast the effect of commands; nothing moves.

    A copy of the simulated station, with the same world and the same state of
    controllers, carries the commands out ahead of time. A stepped station then makes
    the same motion, bit for bit. A command with a certificate is carried out only if
    the conditions of the rehearsal have not changed, and the station stops if the robot
    leaves the rehearsed motion.

    For a real Franka arm at rest, a simulated model of the arm is used (`twin`).
    """
    steps = [step.as_input() for step in request.steps]
    return services.rehearsals.rehearse(
        steps,
        request.seconds,
        certify=request.certificate,
        is_agent=access.role is Role.AGENT,
        who=access.name,
    )


@router.post("/plan", **change(404, 409, 413, 422, 429, 503))
def plan(request: PlanRequest, services: ServicesDep, access: AccessDep) -> Plan:
    """Plan a path without collisions to a target; nothing moves.

    The target is a pose of joints, a pose of the end effector, or a named pose. The
    path keeps 10 mm from all bodies at its corners and 6 mm in between, unless they are
    nearer at its beginning; it respects the limits, and has been rehearsed. If no path
    is found, the answer has the reason: the bodies that would touch in the pose,
    the joint that would leave its range or is at its end, or that time ran out.

    For a real Franka arm at rest, a simulated model of the arm is used (`twin`).
    """
    place = request.pose
    wish = Wish(
        request.controller,
        request.positions or {},
        None if place is None else (place.position, place.quaternion()),
        request.timeout,
        request.seed,
        request.name or "",
    )
    return services.rehearsals.plan(wish, access.name)


class ByRehearsal:
    """Gives the command of one request under the caller's policy and certificate."""

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
    def giving(
        self, kind: str, command: Mapping[str, object], *, moves: bool = True
    ) -> Iterator[CommandTicket | None]:
        """Give a command in the body of a `with`, which must not wait for the robot.

        Args:
            kind: Kind of the command, as in a step of a rehearsal.
            command: Arguments of the command, as in the step.
            moves: Whether the command can move the robot, and so may need a rehearsal.
        """
        rehearsals, step = self._rehearsals, {"kind": kind, **command}
        with rehearsals.redeemed(
            self._certificate, step, is_agent=self._is_agent
        ) as ticket:
            if moves:
                rehearsals.check(is_agent=self._is_agent)
            policy = rehearsals.rules.policy_of(is_agent=self._is_agent)
            if policy is Policy.ADVISE and self._certificate is None:
                self._response.headers[REHEARSAL_HEADER] = "advised"
            yield ticket


def is_hold(trajectory: Mapping[str, object]) -> bool:
    """Return whether a trajectory only stops the joints: it has no points."""
    return not trajectory.get("points")


ByRehearsalDep = Annotated[ByRehearsal, Depends()]
