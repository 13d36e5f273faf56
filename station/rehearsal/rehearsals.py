"""Rehearse commands in a copy of the station, with certificates and policies."""

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from station.core.control.controller import ControllerState
from station.core.errors import (
    InvalidCommandError,
    NoPathError,
    RehearsalError,
    RehearsalNeededError,
    StationError,
    suggest,
)
from station.core.ports.command_ticket import CommandTicket
from station.rehearsal.certificates import Certificates, Conditions, Tolerances
from station.rehearsal.envelope import Envelope, Hands
from station.rehearsal.planning import Wish, plan
from station.rehearsal.pose_goals import EndEffector, end_effectors
from station.rehearsal.process_copy import run_in_copy
from station.rehearsal.run_ahead import (
    AT_REST,
    REST_CYCLES,
    Forecast,
    Plans,
    Script,
    run_ahead,
)
from station.reports import Plan, Rehearsal, RehearsalOutcome

if TYPE_CHECKING:
    from station.core.facade.station import Station

_ATTEMPTS = 4
"""Most paths that are planned and rehearsed for one request."""
BURST = 5
"""Number of copies of a live station that a client may request in a row."""
INTERVAL = 1.0
"""Time after which a client may request one more copy [s]. A copy delays the loop by 2
to 6 ms, so a client costs a live loop less than 1 % of its cycles."""

ResultT = TypeVar("ResultT")


class RunModel(Protocol):
    """Runs a function on the model of a real robot, without delaying its station."""

    def __call__(
        self, station: "Station", work: Callable[["Station"], ResultT], /
    ) -> ResultT:
        """Call `work` with a model of the station, and return its result.

        Args:
            station: The station.
            work: Function that is called with the model; it can be pickled, and the
                model is not used afterwards.

        Raises:
            RehearsalError: There is no model.
        """
        ...


_redeemed: ContextVar[bool] = ContextVar("redeemed", default=False)
"""Whether the present command has the certificate of a rehearsal."""


class AgentEnvelopeError(StationError, ValueError):
    """A motion would leave the envelope of agents."""

    code = "outside_envelope"


class TooManyRehearsalsError(StationError, RuntimeError):
    """A client has requested too many copies of a live station in a row."""

    code = "too_many_rehearsals"


class Policy(StrEnum):
    """Rule that says whether a motion needs a rehearsal."""

    OFF = "off"
    """A motion needs no rehearsal."""
    ADVISE = "advise"
    """A motion should be rehearsed: the answer to a command without a certificate says
    so."""
    REQUIRED = "required"
    """A command without a certificate is refused."""


@dataclass(frozen=True, slots=True)
class Rules:
    """The policies of a station.

    Attributes:
        operator: For people, and for every token that is not an agent's.
        agent: For programs that decide by themselves, with tokens of the role `agent`.
        envelope: Bounds of the motions of agents.
        tolerances: Largest distances of the robot from the rehearsed motion.
    """

    operator: Policy = Policy.OFF
    agent: Policy = Policy.REQUIRED
    envelope: Envelope = field(default_factory=Envelope)
    tolerances: Tolerances = field(default_factory=Tolerances)

    def policy_of(self, *, is_agent: bool) -> Policy:
        """Return the policy for an agent, or for every other client."""
        return self.agent if is_agent else self.operator


class RehearsalRate:
    """Limits how often copies for one client may delay a live loop. Any thread.

    Args:
        now: Monotonic clock [s].
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._lock = threading.Lock()
        self._paid_until: dict[str, float] = {}

    def check(self, who: str | None) -> None:
        """Refuse another copy for a client that has requested too many in a row.

        Args:
            who: Name of the client, since each client has a limit of its own; None is
                never refused.

        Raises:
            TooManyRehearsalsError: The client has requested too many in a row.
        """
        since = self._paid_until.get(who or "", -math.inf) - self._now()
        wait = since - (BURST - 1) * INTERVAL
        if wait > 0.0:
            raise TooManyRehearsalsError(
                f"{who} has rehearsed {BURST} times in a row; each time takes the "
                "processor from a live station.",
                remedy=f"The next one is possible in {wait:.1f} s.",
                details={"retry_after": wait},
            )

    def count(self, who: str) -> None:
        """Count a copy of a live station for a client."""
        with self._lock:
            now, known = self._now(), self._paid_until.items()
            # Forget clients whose waiting time is over, so that names are not kept for
            # ever.
            kept = {name: until for name, until in known if until > now}
            self._paid_until = {**kept, who: max(kept.get(who, now), now) + INTERVAL}


class Rehearsals:
    """Rehearses commands, and lets clients give them as rehearsed. Any thread.

    Args:
        station: The station.
        plans: Functions that turn steps of further kinds into inputs, by kind.
        rules: The policies.
        now: Monotonic clock [s], for the rate of each client.
        run_model: Rehearses with a model of a real robot; with None real robots are
            refused.

    Attributes:
        rules: The policies.
        rate: Bounds the rate of each client.
    """

    def __init__(
        self,
        station: "Station",
        plans: Plans | None = None,
        rules: Rules | None = None,
        now: Callable[[], float] = time.monotonic,
        run_model: RunModel | None = None,
    ) -> None:
        self._run_model = run_model
        self.rules = rules or Rules()
        self.rate = RehearsalRate(now)
        self._station = station
        self._plans = plans or {}
        self._certificates = Certificates(station, self.rules.tolerances)
        self._busy = threading.Lock()

    def adopt(self, rules: Rules, run_model: RunModel | None = None) -> None:
        """Follow new rules; certificates issued before become void.

        Args:
            rules: The policies.
            run_model: Rehearses with a model of a real robot; None keeps the present
                one.
        """
        self.rules = rules
        self._run_model = run_model or self._run_model
        self._certificates = Certificates(self._station, rules.tolerances)

    def rehearse(
        self,
        steps: Sequence[Mapping[str, Any]],
        seconds: float | None = None,
        *,
        certify: bool = False,
        is_agent: bool = False,
        who: str | None = None,
    ) -> Rehearsal:
        """Carry steps out in a copy of the station; nothing moves.

        A real robot cannot be copied: a model of it carries them out.

        Args:
            steps: Inputs with `kind`, their arguments, and `at`, the time at which they
                are carried out [s since the beginning].
            seconds: How long the rehearsal lasts [s]; None ends it when the goals have
                ended and the joints stand still, after 30 s at the latest.
            certify: Whether to issue a certificate.
            is_agent: Whether an agent asks; the envelope applies to its motions.
            who: Name of the client; None for the program that the station runs in.

        Raises:
            RehearsalError: The robot is real and moves or has no model, another
                rehearsal is under way, or this machine cannot copy the station.
            TooManyRehearsalsError: The client has requested too many in a row.
        """
        run_model = self._model_of_standing_robot()
        self.rate.check(who)
        self._pay(who)
        begun = time.perf_counter()
        with self._alone():
            found = self._foresee(Script(steps, seconds), run_model)
        rehearsal = replace(found.rehearsal, wall_time=time.perf_counter() - begun)
        if is_agent and rehearsal.outcome is RehearsalOutcome.COMPLETED:
            names, tube = self._station.joint_names, self.rules.tolerances.tube
            fault = self.rules.envelope.fault(found, names, tube, self._hands())
            if fault is not None:
                rehearsal = replace(
                    rehearsal, outcome=RehearsalOutcome.FAILED, error=fault
                )
        if (
            certify
            and found.is_whole
            and rehearsal.outcome is RehearsalOutcome.COMPLETED
        ):
            issue = self._certificates.issue
            certificate = issue(
                steps, found.conditions, found.positions, is_bounded=is_agent
            )
            rehearsal = replace(rehearsal, certificate=certificate)
        return rehearsal

    def plan(self, wish: Wish, who: str | None = None) -> Plan:
        """Return a path without collisions to a pose; nothing moves.

        The station rehearses the path, and searches for another one if the rehearsal
        fails. For a real robot both happen in a model of it.

        Args:
            wish: Target and limits of the search.
            who: Name of the client; None for the program that the station runs in.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidCommandError: The controller takes no trajectories, has no such
                joint, or moves no end effector, or the robot has no such pose.
            InvalidTrajectoryError: A joint would leave its range.
            NoPathError: The pose touches something or is out of reach, or no path was
                found in time.
            RehearsalError: The robot is real and moves or has no model, another
                rehearsal is under way, or this machine cannot copy the station.
            TooManyRehearsalsError: The client has requested too many in a row.
        """
        run_model = self._model_of_standing_robot()
        self.rate.check(who)
        begun, error = time.perf_counter(), ""
        if run_model is not None:
            self._pay(who)
            with self._alone():
                found = run_model(self._station, partial(_plan_with, wish))
            taken = time.perf_counter() - begun
            return replace(found, planning_time=taken, twin="model")
        if wish.name:
            named = self._named_pose(wish.controller, wish.name)
            wish = replace(wish, positions=named)
        for attempt in range(_ATTEMPTS):
            found = plan(self._station, replace(wish, seed=wish.seed + attempt))
            goal = {"kind": "goal", "name": wish.controller, "request": found.goal}
            # Count all copies of the search afterwards, so that it is not refused half
            # done.
            self._pay(who)
            rehearsal = self.rehearse([{**goal, "at": 0.0}])
            if rehearsal.outcome is RehearsalOutcome.COMPLETED:
                return replace(found, planning_time=time.perf_counter() - begun)
            error = (
                rehearsal.outcome if rehearsal.error is None else rehearsal.error.text
            )
        raise NoPathError(
            f"None of {_ATTEMPTS} paths could be followed; the last one ends with: "
            f"{error}",
            remedy="Plan again with another seed, or go by way of another pose.",
            details={"cause": "rehearsal"},
        )

    def _named_pose(self, controller: str, name: str) -> dict[str, float]:
        """Return a named pose of the simulated robot for the joints of a controller.

        Raises:
            ControllerNotFoundError: There is no such controller.
            InvalidCommandError: The robot has no such pose, or the pose has none of
                these joints.
        """
        world = self._station.loop.hw.simulated_world()
        poses = {} if world is None else world.keyframes()
        joints = self._station.manager.get_controller(controller).joint_names
        found = {k: q for k, q in poses.get(name, {}).items() if k in joints}
        if not found:
            raise InvalidCommandError(
                f"The robot has no pose '{name}' of the joints of '{controller}'.",
                remedy=suggest(name, poses),
            )
        return found

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Keep other rehearsals waiting in the body of a `with`.

        Raises:
            RehearsalError: Another rehearsal is under way.
        """
        if not self._busy.acquire(timeout=1.0):
            raise RehearsalError(
                "Another rehearsal is under way.", remedy="Try again in a moment."
            )
        try:
            yield
        finally:
            self._busy.release()

    def _foresee(self, script: Script, run_model: RunModel | None) -> Forecast:
        """Carry out a script in a copy, or with a model if there is one.

        Raises:
            RehearsalError: The copy or the model cannot carry the script out.
        """
        station = self._station
        if run_model is None:
            return run_in_copy(
                lambda tell: run_ahead(station, script, self._plans, tell),
                station.loop.wait_between_cycles,
            )
        conditions, steps = Conditions.of(station), []
        for step in script.steps:
            plan_step = self._plans.get(str(step["kind"]))
            # The model has no saved paths, so the station plans the goal here, from the
            # robot's present position.
            if plan_step is not None and float(step["at"]) > 0.0:
                raise RehearsalError(
                    "With a model a path is rehearsed from the beginning alone.",
                    remedy="Leave `at` out, or rehearse the path by itself.",
                )
            planned = step if plan_step is None else plan_step(step)
            steps.append({**planned, "at": step["at"]})
        found = run_model(station, partial(_move, replace(script, steps=steps)))
        # The conditions of a certificate are those of the real robot, not of the model.
        report = replace(found.rehearsal, twin="model")
        return replace(found, rehearsal=report, conditions=conditions)

    def _model_of_standing_robot(self) -> RunModel | None:
        """Return the model of a real robot that stands still; None for a simulated one.

        Raises:
            RehearsalError: The real robot has no model, a goal is under way, or a joint
                moves: the model can only begin at rest.
        """
        station = self._station
        if station.loop.hw.simulated_world() is not None:
            return None
        if self._run_model is None:
            raise RehearsalError(
                "A real robot cannot be copied.",
                remedy="Rehearse on a simulated station with the same configuration.",
            )
        remedy = "Wait until the robot stands still, and rehearse again."
        for status in station.controllers():
            if status.state is ControllerState.LOADING:
                continue
            port = station.manager.get_controller(status.name).goals
            if port is not None and any(not one.is_final() for one in port.goals()):
                raise RehearsalError(
                    f"A goal of '{status.name}' is under way.", remedy=remedy
                )
        cycle = station.latest().cycle
        rows = station.snapshots.rows_since(cycle - REST_CYCLES).states_of_joints()
        moved = np.ptp(rows[:, 0], axis=0) if len(rows) else np.zeros(0)
        for joint, far in zip(station.joint_names, moved, strict=False):
            if not far < AT_REST:
                raise RehearsalError(
                    f"{joint} moves: by {far:.4f} in the last {len(rows)} cycles.",
                    remedy=remedy,
                )
        return self._run_model

    def _pay(self, who: str | None) -> None:
        """Count a copy for its client if the station is live."""
        loop = self._station.loop
        if who is not None and loop.advances:
            self.rate.count(who)

    @contextmanager
    def redeemed(
        self,
        certificate: str | None,
        command: Mapping[str, Any],
        *,
        is_agent: bool = False,
    ) -> Iterator[CommandTicket | None]:
        """Let a command be given in the body of a `with`, by its certificate if any.

        Args:
            certificate: Name of the certificate; None without one.
            command: The command, as a step of a rehearsal.
            is_agent: Whether an agent gives the command.

        Raises:
            CertificateNotFoundError: The certificate does not exist, or has expired.
            CertificateVoidError: The certificate is for another command or not for
                agents, or a condition of the rehearsal has changed; nothing moves.
            LoopError: The loop died or hangs.
        """
        if certificate is None:
            yield None
            return
        redeem = self._certificates.redeem
        with redeem(certificate, command, is_agent=is_agent) as ticket:
            before = _redeemed.set(True)
            try:
                yield ticket
            finally:
                _redeemed.reset(before)

    def check_agent(self, certificate: str | None) -> None:
        """Refuse a motion of an agent before a person is asked to allow it.

        Args:
            certificate: Name of the motion's certificate; None without one.

        Raises:
            RehearsalNeededError: The policy requires a rehearsal, and the motion has no
                certificate.
            CertificateNotFoundError: The certificate does not exist, or has expired.
            CertificateVoidError: The certificate is not for agents, or a condition of
                the rehearsal has changed.
            LoopError: The loop died or hangs.
        """
        if certificate is None:
            self.check(is_agent=True)
        else:
            self._certificates.check(certificate)

    def check(self, *, is_agent: bool) -> None:
        """Refuse a motion that needs a rehearsal and has no certificate.

        Args:
            is_agent: Whether an agent gives the command.

        Raises:
            RehearsalNeededError: The caller's policy requires a rehearsal.
        """
        policy = self.rules.policy_of(is_agent=is_agent)
        if policy is Policy.REQUIRED and not _redeemed.get():
            raise RehearsalNeededError(
                "The robot may be moved only as it was rehearsed.",
                remedy="Rehearse the command with `certificate: true`, and give it "
                "with the certificate of the answer. Only one motion, which begins at "
                "once and comes to rest, gets one.",
            )

    def _hands(self) -> Hands:
        names = self._station.joint_names
        return {
            arm: partial(_place, effector, [names.index(j) for j in effector.joints])
            for arm, effector in end_effectors(self._station).items()
        }

    def check_range(self, joint: str, size: float) -> None:
        """Refuse an agent's test of a joint that would leave the envelope.

        Args:
            joint: Name of the joint.
            size: Largest offset from the present position [rad or m].

        Raises:
            AgentEnvelopeError: The test would leave the envelope.
        """
        names, now = self._station.joint_names, self._station.latest()
        if joint not in names:
            return  # the bench will refuse an unknown joint
        q = np.array(now.position)
        check = self.rules.envelope.check_range
        text = check(q, names, joint, size, self._hands())
        if text is not None:
            raise AgentEnvelopeError(text, remedy="Ask for less, or ask a person.")


def _move(script: Script, model: "Station") -> Forecast:
    """Carry out a script with a model.

    Raises:
        RehearsalError: The model was copied in the middle of a cycle.
    """
    found = run_ahead(model, script, {}, lambda: None)
    if found is None:
        raise RehearsalError("The model stands in the middle of a cycle.")
    return found


def _plan_with(wish: Wish, model: "Station") -> Plan:
    return Rehearsals(model).plan(wish)


def _place(
    effector: EndEffector, columns: Sequence[int], q: NDArray[np.float64]
) -> list[float]:
    return effector.pose(q[columns])[12:15]
