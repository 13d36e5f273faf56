"""The desired joint motion inside the arm: q_d, dq_d and ddq_d."""


class DesiredMotion:
    """Desired positions, velocities and accelerations of n joints.

    Exactly one of `hold`, `extrapolate`, `follow_positions` and `follow_velocities`
    is called per cycle. All of them start from the present desired motion, so q_d never
    jumps unless a commanded position does. No allocated memory is kept.

    Args:
        q_d: Desired positions [rad], shape (n,). All three lists change in place.
        dq_d: Desired velocities [rad/s], shape (n,).
        ddq_d: Desired accelerations [rad/s^2], shape (n,).
        lower: Lower position limits [rad], shape (n,).
        upper: Upper position limits [rad], shape (n,).
        deceleration: Deceleration of `hold`, > 0 [rad/s^2], shape (n,).
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self,
        q_d: list[float],
        dq_d: list[float],
        ddq_d: list[float],
        *,
        lower: list[float],
        upper: list[float],
        deceleration: list[float],
        period: float,
    ) -> None:
        self._q_d = q_d
        self._dq_d = dq_d
        self._ddq_d = ddq_d
        self._lower = list(lower)
        self._upper = list(upper)
        self._largest_step = [a * period for a in deceleration]
        self._period = period

    @property
    def is_at_rest(self) -> bool:
        """Whether all desired velocities are zero."""
        return not any(self._dq_d)

    def seed(self, q: list[float], dq: list[float]) -> None:
        """Continue from another motion, e.g. the measured motion.

        Args:
            q: Positions [rad], shape (n,).
            dq: Velocities [rad/s], shape (n,).
        """
        self._q_d[:] = q
        self._dq_d[:] = dq
        self._ddq_d[:] = [0.0] * len(q)

    def hold(self) -> None:
        """Slow down to rest, then hold the positions."""
        if not any(self._dq_d) and not any(self._ddq_d):
            return
        velocities = []
        for dq_d, step in zip(self._dq_d, self._largest_step, strict=True):
            if dq_d > step:
                velocities.append(dq_d - step)
            elif dq_d < -step:
                velocities.append(dq_d + step)
            else:
                velocities.append(0.0)
        self.follow_velocities(velocities)

    def extrapolate(self) -> None:
        """Go on with constant acceleration, because no command has arrived."""
        self.follow_velocities([
            dq_d + ddq_d * self._period
            for dq_d, ddq_d in zip(self._dq_d, self._ddq_d, strict=True)
        ])

    def follow_velocities(self, dq: list[float]) -> None:
        """Move on with commanded velocities; at a position limit a joint stops.

        Args:
            dq: Commanded velocities [rad/s], shape (n,).
        """
        period = self._period
        for i, velocity in enumerate(dq):
            q_d = self._q_d[i] + velocity * period
            reached = velocity
            # A joint beyond its limit may stay or come back; otherwise it could never
            # return to its range.
            if q_d > self._upper[i] and velocity > 0.0:
                q_d, reached = max(self._upper[i], self._q_d[i]), 0.0
            elif q_d < self._lower[i] and velocity < 0.0:
                q_d, reached = min(self._lower[i], self._q_d[i]), 0.0
            self._ddq_d[i] = (reached - self._dq_d[i]) / period
            self._dq_d[i] = reached
            self._q_d[i] = q_d

    def follow_positions(self, q: list[float]) -> None:
        """Go to commanded positions within this cycle.

        Velocities and accelerations follow by backward differences.

        Args:
            q: Commanded positions [rad], shape (n,).
        """
        period = self._period
        for i, position in enumerate(q):
            velocity = (position - self._q_d[i]) / period
            self._ddq_d[i] = (velocity - self._dq_d[i]) / period
            self._dq_d[i] = velocity
            self._q_d[i] = position
