"""Motion of a joint-controlled arm under a force, as of a mass, a damper and a spring.

With the force F at the sensor, and the way x of the sensor from its reference:

    a = M^-1 (S F - D dx - K x)
    ddq = J^T (J J^T + alpha)^-1 a - d dq
    dq += ddq dt, dq_0 += dq dt, q_d = q_ref + dq_0

S, M, D and K are diagonal in the axes of the control frame. S selects axes. F is the
measured wrench less the weight of the tool, smoothed.

Source: ros2_controllers@6.x admittance_controller/admittance_rule_impl.hpp; the inverse
of J is that of kinematics_interface_kdl.
"""

from station.core.numerics.arm_chain import (
    JointChain,
    WrenchEquation,
    torques_of,
    turn_to_inner_axes,
    turn_to_outer_axes,
    twist_of,
)
from station.core.numerics.rigid_motion import twist_between
from station.memory.doubles import Doubles, doubles, zeros


class AdmittanceRule:
    """The rule of one arm with n joints; every array is kept.

    Args:
        size: The number n of joints.
        sensor: Chain to the frame of the sensor.
        reference: A second chain to that frame, for the reference.
        control: Chain to the control frame.
        centre: Chain to the frame in which the centre of gravity is given.

    Attributes:
        wrench: Measured wrench, in the axes of the sensor [N, Nm], shape (6,). The
            owner writes it and what follows up to `joint_damping`.
        weight: Weight of the tool in the axes of the base [N], shape (3,).
        centre_of_gravity: Centre of gravity of the tool in the frame `centre` [m],
            shape (3,).
        selected: 1 for each axis that a force moves, shape (6,).
        inverse_mass: Inverse masses [1/kg, 1/(kg m^2)], shape (6,).
        damping: Dampings [N s/m, Nm s/rad], shape (6,).
        stiffness: Stiffnesses [N/m, Nm/rad], shape (6,).
        smoothing: Share of a new measurement in the force, 0 to 1.
        inverse_damping: The number alpha, > 0.
        joint_damping: The number d [1/s], >= 0.
        force: The force F in the axes of the base [N, Nm], shape (6,).
        error: The way x in the axes of the base [m, rad], shape (6,).
        velocity: The velocity dx in the axes of the base, shape (6,).
        positions: Way of the joints from their reference [rad or m], shape (n,).
        velocities: Velocities of the joints along that way, shape (n,).
        accelerations: Their accelerations, shape (n,).
    """

    def __init__(
        self,
        size: int,
        sensor: JointChain,
        reference: JointChain,
        control: JointChain,
        centre: JointChain,
    ) -> None:
        self.size = size
        self.sensor = sensor
        self.reference = reference
        self.control = control
        self.centre = centre
        self.equation = WrenchEquation()
        self.wrench = zeros(6)
        self.weight = zeros(3)
        self.centre_of_gravity = zeros(3)
        self.selected = doubles([1.0] * 6)
        self.inverse_mass = doubles([1.0] * 6)
        self.damping = zeros(6)
        self.stiffness = zeros(6)
        self.smoothing = 1.0
        self.inverse_damping = 0.01
        self.joint_damping = 0.0
        self.force = zeros(6)
        self.error = zeros(6)
        self.velocity = zeros(6)
        self.positions = zeros(size)
        self.velocities = zeros(size)
        self.accelerations = zeros(size)
        self.measured = zeros(6)
        self.turned = zeros(6)
        self.arm = zeros(3)
        self.sum = zeros(6)

    def reset(self) -> None:
        """Forget force and motion."""
        for k in range(6):
            self.force[k] = self.velocity[k] = self.error[k] = 0.0
        for joint in range(self.size):
            self.positions[joint] = self.velocities[joint] = 0.0
            self.accelerations[joint] = 0.0

    def compute_motion(self, q: Doubles, q_ref: Doubles, period: float) -> None:
        """Move the joints on from their reference.

        Args:
            q: Measured positions of the joints [rad or m], shape (n,).
            q_ref: Their reference, shape (n,).
            period: Time since the last cycle [s], >= 0.
        """
        sensor, turned, total = self.sensor, self.turned, self.sum
        sensor.place(q)
        sensor.differentiate()
        self.reference.place(q_ref)
        self.control.place(q)
        self.centre.place(q)
        # The measurement without the weight of the tool.
        measured, weight, arm, force = self.measured, self.weight, self.arm, self.force
        turn_to_outer_axes(self.sensor.pose, self.wrench, measured)
        turn_to_outer_axes(self.centre.pose, self.centre_of_gravity, arm)
        for k in range(3):
            measured[k] -= weight[k]
        measured[3] -= arm[1] * weight[2] - arm[2] * weight[1]
        measured[4] -= arm[2] * weight[0] - arm[0] * weight[2]
        measured[5] -= arm[0] * weight[1] - arm[1] * weight[0]
        for k in range(6):
            force[k] = self.smoothing * measured[k] + (1.0 - self.smoothing) * force[k]
        twist_between(self.reference.pose, sensor.pose, 1.0, self.error)
        frame = self.control.pose
        turn_to_inner_axes(frame, self.force, turned)
        for k in range(6):
            total[k] = self.selected[k] * turned[k]
        turn_to_inner_axes(frame, self.velocity, turned)
        for k in range(6):
            total[k] -= self.damping[k] * turned[k]
        turn_to_inner_axes(frame, self.error, turned)
        for k in range(6):
            total[k] -= self.stiffness[k] * turned[k]
        for k in range(6):
            total[k] *= self.inverse_mass[k]
        turn_to_outer_axes(frame, total, total)
        # Never singular with a damping above 0, unless a number is not finite.
        if self.equation.factorise(sensor.jacobian, self.inverse_damping):
            self.equation.solve(total, total)
        torques_of(sensor.jacobian, total, self.accelerations)
        for joint in range(self.size):
            self.accelerations[joint] -= self.joint_damping * self.velocities[joint]
            self.velocities[joint] += self.accelerations[joint] * period
            self.positions[joint] += self.velocities[joint] * period
        twist_of(sensor.jacobian, self.velocities, self.velocity)
