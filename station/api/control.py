"""The lease of control, by which one operator keeps others from making changes.

A lease does not protect against a malicious operator, because every operator may take
it by force. It keeps two people from moving the same robot without knowing it.
"""

import asyncio
import hmac
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from station.api.agents import AgentRefusedError
from station.api.auth import Access, Role
from station.core.errors import StationError
from station.events import EventKind, EventLog, Origin, Severity


class ControlHeldError(StationError, PermissionError):
    """Another client holds control."""

    code = "control_held"


class ControlNotHeldError(StationError, RuntimeError):
    """The caller does not hold control."""

    code = "control_not_held"


@dataclass(frozen=True, slots=True)
class Lease:
    """The control of the station, held by one client.

    Attributes:
        owner: Name of the person or program.
        key: Proves the lease; only its holder knows it.
        access: Rights of the holder, and their proof.
        since: Wall time at which the lease began [s since 1970].
        ttl: How long it lasts after a heartbeat [s], > 0.
        deadline: When the lease ends without a heartbeat [s, monotonic].
        heir: Name of the client that may take over without force; None without one.
        commanded: Names of the controllers commanded under the lease.
    """

    owner: str
    key: str
    access: Access
    since: float
    ttl: float
    deadline: float
    heir: str | None = None
    commanded: set[str] = field(default_factory=set)

    def yields_to(self, access: Access) -> bool:
        """Return whether an agent holds control and the caller is a person.

        A person has priority: an agent's lease ends when a person makes a change.
        """
        return self.access.role is Role.AGENT and access.role is Role.OPERATOR

    def is_held_by(self, access: Access, key: str | None) -> bool:
        """Return whether a request comes from the holder.

        A named token or a browser's session belongs to one person. The station's own
        tokens may be shared, so for them the key decides.
        """
        mine = self.access
        if key is not None and hmac.compare_digest(key.encode(), self.key.encode()):
            return access.role is mine.role
        if access.session is not None:
            return access.session is mine.session
        return access.token is not None and access.token is mine.token


class Control:
    """The lease of control, held by one client or none. Any thread.

    Args:
        log: Records the changes of the lease.
        let_go: Function that holds controllers. When the lease was taken by force or
            has expired, it is called with the names of the controllers that the former
            owner commanded, and a sentence with the reason.
        now: Monotonic clock [s].
        rehearsed: Called before a motion, with `is_agent`; raises an error if the
            motion needs a rehearsal and has none.
    """

    def __init__(
        self,
        log: EventLog,
        let_go: Callable[[set[str], str], None],
        now: Callable[[], float] = time.monotonic,
        rehearsed: Callable[..., None] = lambda **_: None,
    ) -> None:
        self._rehearsed = rehearsed
        self._log = log
        self._let_go = let_go
        self._now = now
        self._lock = threading.RLock()
        self._lease: Lease | None = None
        self._listeners: dict[object, Callable[[], None]] = {}

    def present(self) -> Lease | None:
        """Return the lease; None when no client holds control."""
        self.look()
        return self._lease

    def look(self) -> None:
        """End the lease if it has expired or its owner's token was revoked."""
        with self._lock:
            lease = self._lease
            if lease is None:
                return
            if lease.access.has_ended():
                why = "the owner's token or session has ended"
            elif self._now() >= lease.deadline:
                why = f"no heartbeat came for {lease.ttl:g} s"
            else:
                return
            self._lease = None
            text = f"{lease.owner} has lost control: {why}."
            self._record(text, "expired", lease.owner)
            self._let_go(lease.commanded, text)
        self._tell()

    def check(self, access: Access, key: str | None) -> None:
        """Refuse a change if another client holds control.

        A person's change ends an agent's lease; an agent needs a lease for any change.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.

        Raises:
            ControlHeldError: Another client holds control.
            ControlNotHeldError: The caller is an agent, and no client holds control.
        """
        lease = self.present()
        if lease is None:
            if access.role is Role.AGENT:
                error: StationError = _not_held()
                raise error
        elif lease.yields_to(access):
            self._take_back(lease, access.name)
        elif not lease.is_held_by(access, key):
            error = _held(lease)
            raise error

    def _take_back(self, lease: Lease, who: str) -> None:
        with self._lock:
            if self._lease is not lease:
                return
            self._lease = None
            text = f"{who} has taken control back from the agent {lease.owner}."
            self._record(text, "taken back", lease.owner)
            self._let_go(lease.commanded, text)
        self._tell()

    def name_of(self, access: Access, key: str | None) -> str:
        """Return the name of a caller: for the holder of control e.g. `ada (operator)`.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
        """
        lease = self.present()
        if lease is None or not lease.is_held_by(access, key):
            return access.name
        named = f"{lease.owner} ({access.name})"
        return access.name if lease.owner == access.name else named

    def is_lost(self, access: Access, key: str | None) -> bool:
        """Return whether another client holds control."""
        lease = self.present()
        if lease is None or lease.yields_to(access):
            return False
        return not lease.is_held_by(access, key)

    def take(
        self,
        access: Access,
        key: str | None,
        owner: str,
        ttl: float,
        *,
        force: bool = False,
        origin: Origin,
    ) -> Lease:
        """Take control; a call by the owner is a heartbeat.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
            owner: Name of the person or program.
            ttl: How long the lease lasts without a heartbeat [s], > 0.
            force: Whether to take the lease from its holder, and to hold the former
                owner's motions, also for an heir. A person needs no force to take an
                agent's lease, and an agent may not use force.
            origin: Caller, and the caller's address.

        Raises:
            ControlHeldError: Another client holds control and `force` is false, or an
                agent uses force.
            AgentRefusedError: An agent names another owner than itself.
        """
        # Under a person's name an agent would be that person's heir, and people would
        # ask the wrong one to give control back.
        if access.role is Role.AGENT and owner != access.name:
            raise AgentRefusedError(
                f"The agent {access.name} may not take control as '{owner}'.",
                remedy="Leave `owner` out.",
            )
        with self._lock:
            if force and access.role is Role.AGENT:
                raise ControlHeldError(
                    "An agent takes control from nobody by force.",
                    remedy="Take it without `force`, once nobody holds it.",
                )
            lease = self.present()
            if lease is not None and lease.yields_to(access):
                self._take_back(lease, owner)
            before = self.present()
            deadline = self._now() + ttl
            if before is not None and before.is_held_by(access, key):
                self._lease = replace(before, owner=owner, ttl=ttl, deadline=deadline)
                return self._lease
            # An heir who uses force takes control like any other client: motions are
            # held.
            is_heir = (
                before is not None and not force and before.heir in {owner, access.name}
            )
            if before is not None and not is_heir and not force:
                error = _held(before)
                raise error
            self._lease = Lease(
                owner, secrets.token_urlsafe(24), access, time.time(), ttl, deadline
            )
            if before is not None and is_heir:
                # Motions go on under the heir, and are held when the heir loses
                # control.
                self._lease.commanded.update(before.commanded)
            if before is None:
                text, result = f"{owner} has taken control.", "taken"
            elif is_heir:
                text, result = f"{before.owner} handed over to {owner}.", "handed over"
            else:
                text = f"{owner} has taken control from {before.owner} by force."
                result = "forced"
            self._record(text, result, owner, origin, forced=result == "forced")
            if before is not None and result == "forced":
                self._let_go(before.commanded, text)
            taken = self._lease
        self._tell()
        return taken

    def renew(
        self,
        access: Access,
        key: str | None,
        ttl: float | None,
        heir: str | None,
        origin: Origin,
    ) -> Lease:
        """Renew the lease; `heir` may take over without force.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
            ttl: How long the lease lasts from now on without a heartbeat [s]; None
                keeps the time.
            heir: Name of the person or of the named token; None keeps the heir.
            origin: Caller, and the caller's address.

        Raises:
            ControlHeldError: Another client holds control.
            ControlNotHeldError: No client holds control.
        """
        with self._lock:
            lease = self._owned(access, key)
            wanted = lease.ttl if ttl is None else ttl
            self._lease = replace(
                lease,
                ttl=wanted,
                deadline=self._now() + wanted,
                heir=lease.heir if heir is None else heir,
            )
            if heir is not None and heir != lease.heir:
                text = f"{lease.owner} offers control to {heir}."
                self._record(text, "offered", lease.owner, origin)
            return self._lease

    async def keep(self, access: Access, key: str | None) -> None:
        """Renew the lease of a caller until cancelled, or until control is lost.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
        """
        while (lease := self.present()) and lease.is_held_by(access, key):
            with self._lock:
                if self._lease is lease:
                    deadline = self._now() + lease.ttl
                    self._lease = replace(lease, deadline=deadline)
            await asyncio.sleep(lease.ttl / 3.0)

    def release(self, access: Access, key: str | None, origin: Origin) -> None:
        """Give control back; motions go on.

        Raises:
            ControlHeldError: Another client holds control.
            ControlNotHeldError: No client holds control.
        """
        with self._lock:
            lease = self._owned(access, key)
            self._lease = None
            text = f"{lease.owner} has given control back."
            self._record(text, "released", lease.owner, origin)
        self._tell()

    @contextmanager
    def commanding(
        self,
        access: Access,
        key: str | None,
        controller: str,
        *,
        is_bounded: bool = False,
    ) -> Iterator[None]:
        """Allow a set-point in the body of a `with`, which must not wait.

        Control changes hands before the body or after it, never within. So a set-point
        that arrives after a loss of control is refused. The controller of one that came
        before is noted, and is held when control is lost.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
            controller: Name of the controller.
            is_bounded: Whether the station itself chooses and bounds the motion, as the
                bench does, so that it needs no rehearsal.

        Raises:
            ControlHeldError: Another client holds control.
            RehearsalNeededError: The caller's motions need a rehearsal.
        """
        # All set-points pass here: those of the API, of its streams, and of the tool
        # ports.
        if not is_bounded:
            self._rehearsed(is_agent=access.role is Role.AGENT)
        with self._lock:
            self.check(access, key)
            yield
            lease = self._lease
            if lease is not None:
                lease.commanded.add(controller)

    def admit(
        self,
        access: Access,
        key: str | None,
        controller: str,
        *,
        is_bounded: bool = False,
    ) -> None:
        """Check a goal or a trajectory, before it is planned and again afterwards.

        The first call notes the controller. If a client takes control by force in
        between, the controller's earlier goals end, and the second call refuses the new
        goal.

        Args:
            access: Rights of the caller.
            key: Key of the lease that the request names; None without one.
            controller: Name of the controller.
            is_bounded: Whether the station itself chooses and bounds the motion, as the
                bench does, so that it needs no rehearsal.

        Raises:
            ControlHeldError: Another client holds control.
            RehearsalNeededError: The caller's motions need a rehearsal.
        """
        with self.commanding(access, key, controller, is_bounded=is_bounded):
            pass

    def listen(self, changed: Callable[[], None]) -> Callable[[], None]:
        """Call `changed` at every change of control; return a function to end this.

        Any thread may call `changed`; it must return at once.
        """
        key = object()
        with self._lock:
            self._listeners[key] = changed

        def end() -> None:
            with self._lock:
                self._listeners.pop(key, None)

        return end

    def _owned(self, access: Access, key: str | None) -> Lease:
        lease = self.present()
        if lease is None:
            error: StationError = _not_held()
            raise error
        if not lease.is_held_by(access, key):
            error = _held(lease)
            raise error
        return lease

    def _tell(self) -> None:
        with self._lock:
            listeners = list(self._listeners.values())
        for changed in listeners:
            changed()

    def _record(
        self,
        text: str,
        result: str,
        owner: str,
        origin: Origin | None = None,
        *,
        forced: bool = False,
    ) -> None:
        lost = forced or result == "expired"
        self._log.record(
            EventKind.CONTROL,
            text,
            severity=Severity.WARNING if lost else Severity.INFO,
            what=owner,
            result=result,
            origin=Origin() if origin is None else origin,
        )


def _not_held() -> ControlNotHeldError:
    return ControlNotHeldError(
        "Nobody holds control.", remedy="Take control first: POST /api/v1/control."
    )


def _held(lease: Lease) -> ControlHeldError:
    since = datetime.fromtimestamp(lease.since, UTC)
    return ControlHeldError(
        f"{lease.owner} holds control since {since:%Y-%m-%d %H:%M:%S} UTC; nobody else "
        "may change anything.",
        remedy="Wait, ask for a hand-over, or take control by force: POST "
        '/api/v1/control with {"owner": "…", "force": true}. Stopping is always '
        "possible.",
        details={"owner": lease.owner, "since": lease.since},
    )
