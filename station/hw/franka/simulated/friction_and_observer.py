"""Deviations of real joints from their model: friction, noise, an estimate.

    sliding:   tau_f = level / (1 + exp(-slope (dq + shift))) - offset + viscous dq
    sticking:  tau_s = k (z + T dq),  |tau_s|, |k z| <= static / (1 + (dq / v_s)^2)
    bending:   theta = q + compliance tau_J
    observer:  r' = gain (tau_J - M ddq - (1 + error) bias - expected - r)
    wrench:    J J^T F = J r, minus the lasting part that errors explain

The sliding friction is zero at rest, by its offset. At rest the joint sticks: z follows
the joint like a spring of stiffness k = static / presliding with damping, up to the
largest static friction, which decreases with the speed (C. Hess, A. Soom: Friction at a
Lubricated Line Contact Operating at Oscillating Sliding Velocities, Journal of
Tribology 112, 1990). Both frictions act on the link's side of the torque sensor, so the
sensor reads the torque that overcomes them. The observer has the inputs of a real one:
the measured torques, the change of the momentum at the measured velocities, and a model
that is not exact.

In a direction in which J is nearly singular, an error of 1 Nm looks like 10 N or more.
Errors of sensors and model change slowly, the torques of a blow suddenly. So in such a
direction the lasting part of the wrench is left out as far as errors explain it, and
the sudden part is kept.
"""

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING

from station.core.franka.joint_memory import JointMemory
from station.core.numerics.arm_chain import (
    WrenchEquation,
    new_links,
    place_links,
    zero_jacobian,
)
from station.core.numerics.rigid_motion import compose
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.hw.mujoco.world_step import Preparation
from station.memory.doubles import Doubles, doubles, own, zeros
from station.memory.functions import exponential

if TYPE_CHECKING:
    from station.hw.franka.simulated.realism import Realism

WEAK = 1
"""The Jacobian was computed anew, and small torques make a large wrench with it."""
TOUCHED = 2
"""A torque or a component of the wrench is above its lower threshold."""
LOST = 4
"""The next command is lost on its way to the arm."""

_LARGEST_POWER = 700.0  # the exponential of a larger number is not finite
# T above [s], damping over stiffness; it gives at least half of critical damping.
_RELAXATION = 0.005
# Linear congruential generator of 64 bits: D. Knuth, The Art of Computer Programming 2,
# 3.3.4, MMIX. Its low bits are not random, so the high ones are used.
_FACTOR = 6364136223846793005
_STEP = 1442695040888963407
_MASK = 2**64 - 1
_WEAK = WEAK
_TOUCHED = TOUCHED
_LOST = LOST


class FrictionAndObserver(Preparation):
    """Disturbs n joints, and estimates the external torques on them.

    Args:
        memory: State of the joints; its velocities and torques are disturbed.
        simulator: The simulator's memory of the joints, which follow one another from
            a fixed base.
        realism: The friction of the joints, and the errors of sensors and model.
        fields: Returns the memory of a field of the arm's state by libfranka's name;
            the memory is kept.
        chain: The arm's chain of n joints, see `arm_chain`.
        noise: Random numbers of mean 0 and variance 1, used in random order.
        period: Duration of a cycle [s], > 0.

    Attributes:
        level, slope, shift: The sliding friction [Nm, s/rad, rad/s], shape (n,).
        viscous: Friction in proportion to the speed [Nm s/rad], shape (n,).
        static_friction: Largest torque at which a joint stays at rest [Nm], shape (n,).
        stribeck_velocity: Speed v_s at which half of this torque is left [rad/s], > 0.
        presliding: Angle by which a joint turns before it slides [rad], > 0.
        bristle: Present value of this angle, as a share of `presliding`, shape (n,).
        compliance: Turn of the motor against the link [rad/Nm], shape (n,).
        torque_noise: Standard deviation of the torque sensors [Nm], shape (n,).
        torque_bias: Constant error of the torque sensors [Nm], shape (n,).
        velocity_noise: Standard deviation of the velocities [rad/s], shape (n,).
        model_error: Relative error of the bias forces in the observer's model, shape
            (n,).
        expected: Torques of a configured load [Nm], shape (n,).
        lower: Lower thresholds of the torques, then of the wrench, shape (n + 6,).
        jacobian: Jacobian of the stiffness frame, axes of the base, column-major.
        pose: Pose of the stiffness frame, 16 numbers, column-major.
        place: Positions for which Jacobian and pose were computed [rad], shape (n,).
        reach: Largest distance of a joint from these positions [rad].
        gain: Share of the difference by which the estimate moves in a cycle, 0 to 1.
        singular: Smallest singular value of a Jacobian that gives a wrench.
        reliable: Singular value above which no direction is weak.
        has_wrench: Whether the Jacobian is far enough from singular.
        weak: Number of directions in which small torques make a large wrench, 0 to 6.
        directions: These directions, unit wrenches one after another, shape (36,).
        shares: Part of the wrench in each direction per torque of each joint,
            shape (6 n,).
        doubt: Largest part in each direction that errors of the torques explain,
            shape (6,).
        lasting_gain: Share by which `lasting` follows the estimate in a cycle, 0 to 1.
        cycles_to_loss: Number of cycles until a command is lost; 0 for never.
    """

    def __init__(
        self,
        memory: JointMemory,
        simulator: SimulatorMemory,
        realism: "Realism",
        *,
        fields: Callable[[str], Doubles],
        chain: Doubles,
        noise: Doubles,
        period: float,
    ) -> None:
        size = self.size = memory.size
        self.memory = memory
        self.simulator = simulator
        self.chain = own(chain)
        self.tool = fields("F_T_EE")
        self.stiffness_frame = fields("EE_T_K")
        self.links = new_links(chain)
        self.flange = self.links[16 * size :]
        self.noise = noise
        self.estimate = fields("tau_ext_hat_filtered")
        self.theta = fields("theta")
        self.wrench = fields("O_F_ext_hat_K")
        self.turned = fields("K_F_ext_hat_K")
        self.period = period
        self.rate = 1.0 / period
        self.level = doubles(realism.friction_level)
        self.slope = doubles(realism.friction_slope)
        self.shift = doubles(realism.friction_shift)
        self.viscous = doubles(realism.viscous)
        rows = zip(self.level, self.slope, self.shift, strict=True)
        self.offset = doubles(
            level / (1.0 + exponential(-slope * shift)) for level, slope, shift in rows
        )
        self.static_friction = doubles(realism.static_friction)
        self.stribeck_velocity = realism.stribeck_velocity
        self.presliding = realism.presliding
        self.bristle = zeros(size)
        self.compliance = doubles(1.0 / one for one in realism.joint_stiffness)
        self.torque_noise = doubles(realism.torque_noise)
        self.torque_bias = doubles(realism.torque_bias)
        self.velocity_noise = doubles(realism.velocity_noise)
        self.model_error = doubles(realism.model_error)
        self.expected = zeros(size)
        self.lower = zeros(size + 6)
        self.jacobian = zeros(6 * size)
        self.pose = zeros(16)
        self.place = zeros(size)
        self.reach = 0.0
        self.gain = period / (period + 1.0 / (2.0 * pi * realism.observer_frequency))
        self.singular = 0.0
        self.reliable = 0.0
        self.has_wrench = False
        self.weak = 0
        self.directions = zeros(36)
        self.shares = zeros(6 * size)
        self.doubt = zeros(6)
        self.lasting = zeros(size)  # the estimate without sudden changes
        self.lasting_gain = 1.0
        self.following = 1.0
        self.cycles_to_loss = 0
        self.equation = WrenchEquation()
        self.dice = 0
        self.velocity = zeros(size)  # as measured
        self.change = zeros(size)
        self.momentum = zeros(size)

    def rest(self) -> None:
        """Begin anew at rest, without an estimate and with the first random numbers."""
        self.dice = 0
        for i in range(self.size):
            self.velocity[i] = 0.0
            self.bristle[i] = 0.0
            self.estimate[i] = 0.0
            self.lasting[i] = 0.0
        self.following = 1.0
        for i in range(6):
            self.wrench[i] = 0.0
            self.turned[i] = 0.0

    def renew_jacobian(self) -> bool:
        """Compute Jacobian and pose of the stiffness frame at the present positions.

        Returns:
            See `factorise_jacobian`.
        """
        place_links(self.chain, self.memory.positions, self.links)
        compose(self.flange, self.tool, self.pose)
        compose(self.pose, self.stiffness_frame, self.pose)
        zero_jacobian(self.links, self.pose, self.jacobian)
        return self.factorise_jacobian()

    def factorise_jacobian(self) -> bool:
        """Factorise the Jacobian, and find out whether some directions are weak.

        In a weak direction the torques determine a wrench poorly, because the arm is
        close to a singularity.

        Returns:
            Whether the caller has to compute the weak directions.
        """
        equation, jacobian = self.equation, self.jacobian
        singular, reliable = self.singular, self.reliable
        self.weak = 0
        self.has_wrench = equation.factorise(jacobian, -singular * singular)
        is_reliable = self.has_wrench and equation.factorise(
            jacobian, -reliable * reliable
        )
        # Last, because the equation solves with the factors of its last factorisation.
        if self.has_wrench:
            self.has_wrench = equation.factorise(jacobian, 0.0)
        for i in range(self.size):
            self.place[i] = self.memory.positions[i]
        return self.has_wrench and not is_reliable

    def prepare_step(self) -> None:
        """Apply the friction in the coming step."""
        velocities, applied = self.simulator.velocities, self.simulator.applied
        level, slope, shift = self.level, self.slope, self.shift
        offset, static_friction = self.offset, self.static_friction
        viscous = self.viscous
        bristle, share = self.bristle, 1.0 / self.stribeck_velocity
        turn = self.period / self.presliding
        lead = _RELAXATION / self.presliding
        for i in range(self.size):
            velocity = velocities[i]
            power = -slope[i] * (velocity + shift[i])
            if power > _LARGEST_POWER:
                power = _LARGEST_POWER
            sliding = level[i] / (1.0 + exponential(power)) - offset[i]
            sliding += viscous[i] * velocity
            # Shares of the static friction: the largest one at this speed, and the
            # acting one.
            relative = velocity * share
            most = 1.0 / (1.0 + relative * relative)
            bend = bristle[i] + turn * velocity
            if bend > most:
                bend = most
            if bend < -most:
                bend = -most
            bristle[i] = bend
            bend += lead * velocity
            if bend > most:
                bend = most
            if bend < -most:
                bend = -most
            applied[i] = -sliding - static_friction[i] * bend

    def sense(self) -> int:
        """Disturb the readings of the last step, and update the estimates.

        Returns:
            A sum of `WEAK`, `TOUCHED` and `LOST`; usually 0.
        """
        self.disturb()
        self.observe()
        self.compute_wrench()
        result = _TOUCHED if self.is_touched() else 0
        positions, place, reach = self.memory.positions, self.place, self.reach
        for i in range(self.size):
            if abs(positions[i] - place[i]) > reach:
                # The new Jacobian is used from the next cycle on.
                if self.renew_jacobian():
                    result += _WEAK
                break
        if self.cycles_to_loss > 0:
            self.cycles_to_loss -= 1
            if self.cycles_to_loss == 0:
                result += _LOST
        return result

    def disturb(self) -> None:
        """Add noise and bias to velocities and torques, and let the joints bend."""
        memory, noise = self.memory, self.noise
        dq, dtheta, tau = memory.dq, memory.dtheta, memory.tau_J
        velocity, change = self.velocity, self.change
        positions, theta, compliance = memory.positions, self.theta, self.compliance
        spread, bias = self.velocity_noise, self.torque_bias
        torque_spread, count = self.torque_noise, len(noise)
        # Numbers used in their order would be a tone in the spectrum of the noise.
        for i in range(self.size):
            self.dice = (self.dice * _FACTOR + _STEP) & _MASK
            measured = dtheta[i] + spread[i] * noise[(self.dice >> 33) % count]
            self.dice = (self.dice * _FACTOR + _STEP) & _MASK
            error = bias[i] + torque_spread[i] * noise[(self.dice >> 33) % count]
            change[i] = measured - velocity[i]
            velocity[i] = measured
            dq[i] = measured
            error += tau[i]
            tau[i] = error
            theta[i] = positions[i] + compliance[i] * error

    def settle_elasticity(self) -> None:
        """Set the positions of the motors: those of the links plus the joints' bend."""
        memory, theta, compliance = self.memory, self.theta, self.compliance
        positions, tau = memory.positions, memory.tau_J
        for i in range(self.size):
            theta[i] = positions[i] + compliance[i] * tau[i]

    def observe(self) -> None:
        """Move the estimate towards the torques that the motion does not explain."""
        simulator, momentum, change = self.simulator, self.momentum, self.change
        inertia, diagonal = simulator.inertia, simulator.diagonal
        bias, armature = simulator.bias, simulator.armature
        tau, estimate, gain = self.memory.tau_J, self.estimate, self.gain
        rate, model_error, expected = self.rate, self.model_error, self.expected
        lasting, following = self.lasting, self.following
        for i in range(self.size):
            # A row of the inertia matrix ends with its diagonal element. The rotors are
            # on the motor's side of the torque sensors, so they are left out.
            row = diagonal[i] - i
            own = change[i]
            total = (inertia[row + i] - armature[i]) * own
            for j in range(i):
                element = inertia[row + j]
                total += element * change[j]
                momentum[j] += element * own
            momentum[i] = total
        for i in range(self.size):
            needed = momentum[i] * rate + (1.0 + model_error[i]) * bias[i]
            external = tau[i] - needed - expected[i]
            estimate[i] += gain * (external - estimate[i])
            lasting[i] += following * (estimate[i] - lasting[i])
        # At first a mean of all cycles: what acts from the beginning is not sudden.
        if following > self.lasting_gain:
            self.following = following / (1.0 + following)

    def compute_wrench(self) -> None:
        """Compute the wrench of the estimated torques, or 0 near a singular pose."""
        wrench, turned, pose = self.wrench, self.turned, self.pose
        jacobian, estimate = self.jacobian, self.estimate
        u = v = w = a = b = c = 0.0
        if self.has_wrench:
            for i in range(self.size):
                torque, k = estimate[i], 6 * i
                u += jacobian[k] * torque
                v += jacobian[k + 1] * torque
                w += jacobian[k + 2] * torque
                a += jacobian[k + 3] * torque
                b += jacobian[k + 4] * torque
                c += jacobian[k + 5] * torque
        wrench[0], wrench[1], wrench[2], wrench[3] = u, v, w, a
        wrench[4], wrench[5] = b, c
        if self.has_wrench:
            self.equation.solve(wrench, wrench)
            if self.weak:
                self.doubt_wrench()
            u, v, w = wrench[0], wrench[1], wrench[2]
            a, b, c = wrench[3], wrench[4], wrench[5]
        for axis in range(3):
            x, y, z = pose[4 * axis], pose[4 * axis + 1], pose[4 * axis + 2]
            turned[axis] = x * u + y * v + z * w
            turned[axis + 3] = x * a + y * b + z * c

    def doubt_wrench(self) -> None:
        """Subtract the lasting part of the wrench that torque errors explain."""
        wrench, directions, doubt = self.wrench, self.directions, self.doubt
        shares, lasting, size = self.shares, self.lasting, self.size
        for j in range(self.weak):
            k, most = 6 * j, doubt[j]
            part = 0.0
            for i in range(size):
                part += shares[size * j + i] * lasting[i]
            if part > most:
                part = most
            if part < -most:
                part = -most
            for i in range(6):
                wrench[i] -= part * directions[k + i]

    def is_touched(self) -> bool:
        """Return whether an estimate is above its lower threshold."""
        lower, estimate, turned = self.lower, self.estimate, self.turned
        size = self.size
        for i in range(size):
            if not -lower[i] <= estimate[i] <= lower[i]:
                return True
        for i in range(6):
            if not -lower[size + i] <= turned[i] <= lower[size + i]:
                return True
        return False
