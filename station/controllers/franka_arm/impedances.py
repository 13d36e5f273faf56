"""Springs and dampers of an arm: at the end effector, and at the joints.

At the end effector, with the pose error e, the twist J dq and the rest q_n:

    tau = J^T (-bounded(K e) - D J dq) + N (k (q_n - q) - d dq) + c + f

N = 1 - J^T (J J^T)^-1 J keeps the torques of the null space from moving the end
effector: a force F always deflects the spring by F / K. At the joints the torques are

    tau = K (q_d - q) - D dq + c + f

c are the Coriolis torques, f compensates the friction. Stiffnesses, equilibrium and
posture approach their targets through a low-pass filter, so that no change of them is a
step of the torques. The matrix D is designed elsewhere, see `damping_matrix`.

Source: A. Albu-Schäffer, C. Ott, U. Frese, G. Hirzinger: Cartesian impedance control of
redundant robots, ICRA 2003; friction of C. Gaz, M. Cognetti, A. Oliva, P. Robuffo
Giordano, A. De Luca: Dynamic identification of the Franka Emika Panda robot with
retrieval of feasible parameters, RA-L 4(4), 2019.
"""

from station.controllers.franka_arm.cartesian_spring import PoseSpring
from station.core.numerics.arm_chain import torques_of, twist_of
from station.core.numerics.command_rates import filter_commands
from station.memory.doubles import Doubles, doubles, zeros
from station.memory.functions import exponential, square_root

# Share of the distance to a new target that is covered per cycle.
_FILTER = 0.005
# Keeps the null space finite at a singular pose; elsewhere its square root, 0.001, is
# far below the singular values, and the null space moves the end effector by 1e-4.
_INVERSE_DAMPING = 1e-6
_SMALLEST_EXPONENT = -700.0
"""Smallest argument with which `logistic` computes, because exp(710) overflows."""


class Friction:
    """Adds the torques that balance the sliding friction of the joints.

    Args:
        dq: Measured joint velocities [rad/s], shape (n,).
        height: Friction at high speed forwards plus that backwards [Nm], shape (n,).
        slope: Steepness with which friction rises with the speed [s/rad], shape (n,).
        shift: Velocity by which the rise is shifted, so that friction is larger in one
            direction [rad/s], shape (n,).

    Attributes:
        share: Share of the friction that is compensated, 0 to 1.
    """

    def __init__(
        self, dq: Doubles, height: Doubles, slope: Doubles, shift: Doubles
    ) -> None:
        self.dq = dq
        self.height = doubles(height)
        self.slope = doubles(slope)
        self.shift = doubles(shift)
        self.share = 0.0

    def compensate(self, torques: Doubles) -> None:
        """Add the compensating torques to `torques` [Nm], shape (n,)."""
        if self.share == 0.0:
            return
        for joint in range(len(torques)):
            slope, shift = self.slope[joint], self.shift[joint]
            share = logistic(slope * (self.dq[joint] + shift)) - logistic(slope * shift)
            torques[joint] += self.share * self.height[joint] * share


def logistic(value: float) -> float:
    """Return 1 / (1 + exp(-value))."""
    if value < _SMALLEST_EXPONENT:
        value = _SMALLEST_EXPONENT
    return 1.0 / (1.0 + exponential(-value))


class PoseImpedance(PoseSpring):
    """The torques of a spring and a damper at the end effector.

    Attributes:
        axes: Stiffness along [N/m] and about [Nm/rad] the axes of the base, shape (6,).
        wanted_axes: Values that the stiffnesses approach, shape (6,), >= 0.
        dampings: The matrix D, 36 numbers, symmetric; written by the owner.
        posture: Joint positions that the null space approaches [rad], shape (n,).
        slowing: Damping of the null space [Nm s/rad], >= 0.
        largest_force: Largest force of the spring [N], > 0.
        largest_torque: Largest torque of the spring [Nm], > 0.
        friction: Compensates friction; None for none.
    """

    def __init__(
        self,
        q: Doubles,
        dq: Doubles,
        last_torques: Doubles,
        largest_step: float,
        is_angle: bool,  # noqa: FBT001 - positional for the compiler
    ) -> None:
        super().__init__(q, dq, last_torques, largest_step, is_angle)
        self.axes = zeros(6)
        self.wanted_axes = zeros(6)
        self.dampings = zeros(36)
        self.posture = zeros(self.size)
        self.friction: Friction | None = None
        self.slowing = 0.0
        self.largest_force = self.largest_torque = 0.0

    def start_at_rest(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        super().start_at_rest(nullspace)
        for k in range(6):
            self.axes[k] = 0.0
        for k in range(36):
            self.dampings[k] = 0.0

    def bounded(self, first: int, largest: float) -> float:
        """Return the factor that keeps the norm of three numbers within a bound."""
        x, y, z = self.wrench[first], self.wrench[first + 1], self.wrench[first + 2]
        size = square_root(x * x + y * y + z * z)
        return largest / size if size > largest else 1.0

    def balance_error(self) -> None:
        """Write the torques that belong to the error."""
        jacobian = self.jacobian
        twist = self.twist
        wrench = self.wrench
        stray = self.stray
        nullspace = self.stiffness[2]
        for joint in range(self.size):
            away = self.rest[joint] - self.q[joint]
            stray[joint] = nullspace * away - self.slowing * self.dq[joint]
        # The wrench to which the null space is equal, of which nothing is to be left.
        twist_of(jacobian, stray, twist)
        # Not so only where the Jacobian is not finite, and the torques will not be.
        if self.equation.factorise(jacobian, _INVERSE_DAMPING):
            self.equation.solve(twist, twist)
        for k in range(6):
            wrench[k] = -self.axes[k] * self.error[k]
        force = self.bounded(0, self.largest_force)
        torque = self.bounded(3, self.largest_torque)
        for k in range(3):
            wrench[k] = force * wrench[k] - twist[k]
            wrench[3 + k] = torque * wrench[3 + k] - twist[3 + k]
        twist_of(jacobian, self.dq, twist)
        for k in range(6):
            for m in range(6):
                wrench[k] -= self.dampings[6 * k + m] * twist[m]
        torques = self.torques
        torques_of(jacobian, wrench, torques)
        for joint in range(self.size):
            torques[joint] += stray[joint] + self.coriolis[joint]
        if self.friction is not None:
            self.friction.compensate(torques)
        last, step = self.last_torques, self.largest_step
        filter_commands(torques, last, 1.0, step, torques, self.size)

    def approach_targets(self) -> None:
        """Move stiffnesses, equilibrium and posture on towards their targets."""
        PoseSpring.approach_targets(self)
        for k in range(6):
            self.axes[k] += _FILTER * (self.wanted_axes[k] - self.axes[k])
        for joint in range(self.size):
            self.rest[joint] += _FILTER * (self.posture[joint] - self.rest[joint])


class JointImpedance:
    """The torques of springs and dampers at the joints; every array is kept.

    Args:
        q: Measured joint positions [rad], shape (n,).
        dq: Measured joint velocities [rad/s], shape (n,).
        last_torques: Torques commanded in the last cycle [Nm], shape (n,).
        largest_step: Largest change of a torque per cycle [Nm], > 0.
        friction: Compensates friction.

    Attributes:
        stiffness: Stiffnesses [Nm/rad], shape (n,).
        wanted: Values that the stiffnesses approach, shape (n,), >= 0.
        dampings: The matrix D [Nm s/rad], n n numbers; written by the owner.
        desired: Equilibrium [rad], shape (n,).
        target: Positions that the equilibrium approaches [rad], shape (n,).
        coriolis: Coriolis torques [Nm], shape (n,); written by the owner.
        errors: Equilibrium minus measured positions [rad], shape (n,).
        torques: The torques [Nm], shape (n,).
    """

    def __init__(
        self,
        q: Doubles,
        dq: Doubles,
        last_torques: Doubles,
        largest_step: float,
        friction: Friction,
    ) -> None:
        size = len(q)
        self.size = size
        self.q = q
        self.dq = dq
        self.last_torques = last_torques
        self.largest_step = largest_step
        self.friction = friction
        self.stiffness = zeros(size)
        self.wanted = zeros(size)
        self.dampings = zeros(size * size)
        self.desired = zeros(size)
        self.target = zeros(size)
        self.coriolis = zeros(size)
        self.errors = zeros(size)
        self.torques = zeros(size)

    def start_at_rest(self) -> None:
        """Make the present positions the equilibrium, and start without stiffness."""
        for joint in range(self.size):
            self.desired[joint] = self.target[joint] = self.q[joint]
            self.stiffness[joint] = 0.0
        for k in range(self.size * self.size):
            self.dampings[k] = 0.0

    def compute_torques(self) -> None:
        """Write the torques of this cycle, then move on towards the targets."""
        size, torques, dq = self.size, self.torques, self.dq
        for joint in range(size):
            error = self.desired[joint] - self.q[joint]
            torque = self.stiffness[joint] * error + self.coriolis[joint]
            for other in range(size):
                torque -= self.dampings[size * joint + other] * dq[other]
            self.errors[joint] = error
            torques[joint] = torque
        self.friction.compensate(torques)
        last, step = self.last_torques, self.largest_step
        filter_commands(torques, last, 1.0, step, torques, self.size)
        for joint in range(size):
            self.stiffness[joint] += _FILTER * (
                self.wanted[joint] - self.stiffness[joint]
            )
            self.desired[joint] += _FILTER * (self.target[joint] - self.desired[joint])
