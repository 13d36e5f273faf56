"""The memory that the parts of a simulated arm's cycle share."""

from station.memory.doubles import Doubles, given_or_zeros, own_zeros


class JointMemory:
    """State and commands of n joints, each quantity of shape (n,).

    The names are libfranka's, except for `positions`. Each part of the cycle reads and
    writes in place. A quantity that is not given gets its own memory.

    Args:
        size: Number of joints.
        q: Reported positions [rad].
        dq: Reported velocities [rad/s].
        positions: True positions, whatever the sensors report [rad].
        dtheta: True velocities [rad/s].
        tau_J: Link-side torques [Nm].
        dtau_J: Rates of the torques [Nm/s].
        q_d: Desired positions [rad].
        dq_d: Desired velocities [rad/s].
        ddq_d: Desired accelerations [rad/s^2].
        tau_J_d: Desired torques [Nm].

    Attributes:
        target: Commanded positions [rad] or velocities [rad/s].
        target_dq: Velocities that lead to the commanded positions [rad/s].
        last_tau_J: Link-side torques of the cycle before [Nm].
        torques: Commanded torques [Nm].
        sent: Commanded torques of the cycle before [Nm].
    """

    def __init__(
        self,
        size: int,
        *,
        q: Doubles | None = None,
        dq: Doubles | None = None,
        positions: Doubles | None = None,
        dtheta: Doubles | None = None,
        tau_J: Doubles | None = None,  # noqa: N803 - libfranka's name
        dtau_J: Doubles | None = None,  # noqa: N803 - libfranka's name
        q_d: Doubles | None = None,
        dq_d: Doubles | None = None,
        ddq_d: Doubles | None = None,
        tau_J_d: Doubles | None = None,  # noqa: N803 - libfranka's name
    ) -> None:
        self.size = size
        self.q = given_or_zeros(q, size)
        self.dq = given_or_zeros(dq, size)
        self.positions = given_or_zeros(positions, size)
        self.dtheta = given_or_zeros(dtheta, size)
        self.tau_J = given_or_zeros(tau_J, size)
        self.dtau_J = given_or_zeros(dtau_J, size)
        self.q_d = given_or_zeros(q_d, size)
        self.dq_d = given_or_zeros(dq_d, size)
        self.ddq_d = given_or_zeros(ddq_d, size)
        self.tau_J_d = given_or_zeros(tau_J_d, size)
        self.last_tau_J = own_zeros(size)
        self.target = own_zeros(size)
        self.target_dq = own_zeros(size)
        self.torques = own_zeros(size)
        self.sent = own_zeros(size)
