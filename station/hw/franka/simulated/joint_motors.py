"""The motors and torque sensors of an arm's joints in a simulation, over flat memory.

    impedance: control = K q_d + D dq_d + bias - compensation + M_ii ddq_d

The terms of the impedance in q and dq are part of the simulator's motor model.

A real arm's motors act on a command in the cycle after the one in which the arm reports
the command. So do these motors if they are late.
"""

from collections.abc import Sequence

import cython

from station.core.franka.joint_memory import JointMemory
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.memory.doubles import own, put
from station.memory.vectors import copy_into


class JointMotors:
    """Computes controls and reads torques of n joints; it works on given memory.

    Args:
        memory: State and commands of the joints.
        simulator: The simulator's memory of the joints.
        period: Duration of a step [s], > 0.

    Attributes:
        stiffness: Stiffness of the impedance [Nm/rad], shape (n,).
        damping: Damping of the impedance [Nm s/rad], shape (n,).
        load_weight: Torques that carry a configured load [Nm], shape (n,).
        is_loaded: Whether any of these torques is not 0.
        is_late: Whether the motors act on commands one cycle later.
        torques_act: Whether the motors follow commanded torques.
        is_cartesian: Whether the arm itself computes the torques, see `ArmMotors`.
    """

    def __init__(
        self, memory: JointMemory, simulator: SimulatorMemory, period: float
    ) -> None:
        self.memory = memory
        self.simulator = simulator
        self.size = memory.size
        self.period = period
        none = [0.0] * self.size
        self.stiffness = own(none)
        self.damping = own(none)
        self.load_weight = own(none)
        self.is_loaded = False
        # These stay the same during a simulation.
        self.limits = own(simulator.limits)
        self.passive = own(simulator.passive_damping)
        # Torque that changes a rotor's velocity within a step [Nm s/rad], and the sum
        # of this and the friction.
        self.rotor = own([inertia / period for inertia in simulator.armature])
        both = zip(self.rotor, self.passive, strict=True)
        self.drag = own([inertia + friction for inertia, friction in both])
        self.is_late = False
        self.torques_act = False
        self.is_cartesian = False
        self.is_new = True
        # Commands of the cycle before, for late motors.
        self.late_torques = own(none)
        self.late_q = own(none)
        self.late_dq = own(none)
        self.late_ddq = own(none)

    def engage(self, stiffness: Sequence[float], damping: Sequence[float]) -> None:
        """Let an impedance act from the next step on, and forget the stored motion.

        Args:
            stiffness: Stiffness of the joints [Nm/rad], shape (n,).
            damping: Damping of the joints [Nm s/rad], shape (n,).
        """
        put(self.stiffness, stiffness)
        put(self.damping, damping)
        self.torques_act = self.is_cartesian = False
        self.is_new = True
        for i in range(self.size):
            self.late_torques[i] = 0.0

    def apply_torques(self) -> None:
        """Let the motors give the commanded torques, within their limits."""
        torques, tau_d = self.memory.torques, self.memory.tau_J_d
        limits, controls = self.limits, self.simulator.controls
        load, late_torques = self.load_weight, self.late_torques
        for i in range(self.size):
            tau, limit = torques[i], limits[i]
            if limit < tau:
                tau = limit
            if tau < -limit:
                tau = -limit
            tau_d[i] = tau
        if self.is_late and self.torques_act:
            for i in range(self.size):
                controls[i] = late_torques[i] + load[i]
            copy_into(late_torques, 0, tau_d, self.size)
        elif self.is_loaded:
            for i in range(self.size):
                controls[i] = tau_d[i] + load[i]
        elif cython.compiled:
            copy_into(controls, 0, tau_d, self.size)
        else:
            controls[:] = tau_d

    def apply_impedance(self, notes: bool) -> None:  # noqa: FBT001 - a C function
        """Let the motors follow the desired motion.

        Args:
            notes: Whether to write the torques of the impedance to `tau_J_d`, within
                the limits.
        """
        memory = self.memory
        q, dq = memory.positions, memory.dtheta
        q_d, dq_d, ddq_d = memory.q_d, memory.dq_d, memory.ddq_d
        is_late, is_loaded = self.is_late, self.is_loaded
        stiffness, damping = self.stiffness, self.damping
        simulator = self.simulator
        bias, compensation = simulator.bias, simulator.compensation
        if is_late:
            # The stored motion belongs to another motion: the motors would jump to it.
            if self.is_new:
                self.note_motion()
            q_d, dq_d, ddq_d = self.late_q, self.late_dq, self.late_ddq
        inertia, diagonal = simulator.inertia, simulator.diagonal
        controls, load = simulator.controls, self.load_weight
        tau_d, limits = memory.tau_J_d, self.limits
        for i in range(self.size):
            acceleration, spring, damper = ddq_d[i], stiffness[i], damping[i]
            control = spring * q_d[i] + damper * dq_d[i] + bias[i] - compensation[i]
            if acceleration != 0.0:  # an arm that holds needs no inertia
                control += inertia[diagonal[i]] * acceleration
            controls[i] = control + load[i] if is_loaded else control
            if notes:
                tau = control - spring * q[i] - damper * dq[i]
                limit = limits[i]
                if limit < tau:
                    tau = limit
                if tau < -limit:
                    tau = -limit
                tau_d[i] = tau
        if is_late:
            self.note_motion()

    def note_motion(self) -> None:
        """Store the desired motion for the next cycle."""
        memory = self.memory
        q_d, dq_d, ddq_d = memory.q_d, memory.dq_d, memory.ddq_d
        late_q, late_dq, late_ddq = self.late_q, self.late_dq, self.late_ddq
        for i in range(self.size):
            late_q[i], late_dq[i], late_ddq[i] = q_d[i], dq_d[i], ddq_d[i]
        self.is_new = False

    def sense(self) -> None:
        """Read positions, velocities and link-side torques after a step.

        A torque sensor behind the gears measures the torques of motor and brake minus
        the torques that accelerate the rotor and overcome friction. The simulator
        applies the damping of the impedance with the velocity at the end of the step,
        while the motor's reading contains the velocity at the beginning.
        """
        memory = self.memory
        dtheta, tau = memory.dtheta, memory.tau_J
        simulator = self.simulator
        positions, velocities = simulator.positions, simulator.velocities
        motor_forces, brake_forces = simulator.motor_forces, simulator.brake_forces
        compensation, damping = simulator.compensation, self.damping
        drag, rotor, limits = self.drag, self.rotor, self.limits
        if cython.compiled:
            copy_into(memory.last_tau_J, 0, tau, self.size)
        else:
            # The same without a Python call around it.
            memory.last_tau_J[:] = tau
        for i in range(self.size):
            velocity, force, before = velocities[i], motor_forces[i], dtheta[i]
            torque = (force + brake_forces[i] + compensation[i]) + (
                rotor[i] * before - drag[i] * velocity
            )
            damper = damping[i]
            if damper != 0.0:
                limit = limits[i]
                # A motor at its limit does not damp, because its force is cut off.
                if -limit < force < limit:
                    torque -= damper * (velocity - before)
            tau[i] = torque
        if cython.compiled:
            copy_into(memory.q, 0, positions, self.size)
            copy_into(memory.positions, 0, positions, self.size)
            copy_into(memory.dq, 0, velocities, self.size)
            copy_into(dtheta, 0, velocities, self.size)
        else:
            memory.q[:] = memory.positions[:] = positions
            memory.dq[:] = memory.dtheta[:] = simulator.velocities

    def differentiate(self) -> None:
        """Write the rates of the torques; not in every cycle, because few read them."""
        memory, period = self.memory, self.period
        tau, last, dtau = memory.tau_J, memory.last_tau_J, memory.dtau_J
        for i in range(self.size):
            dtau[i] = (tau[i] - last[i]) / period
