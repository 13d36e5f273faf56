"""Drive the joints of a simulated robot by forces or by stable servos.

A servo has a desired velocity v_d, and gives the force that keeps it:

    force = D (v_d - dq) + c(q, dq),    D = 1000/s * M_ii(q)

with M_ii the inertia at the joint and c the force against gravity (unless gravity is
compensated) and Coriolis forces. `D dq` is part of MuJoCo's motor, where the integrator
treats it implicitly: it is stable for every inertia. v_d changes with at most the
acceleration a = 0.3 f_max / M_ii; the rest of the motor's force is left for the effects
of other joints. v_d approaches the velocity target, or with K = 100/s, e = q_target - q
and b = 0.8 a (the difference to a makes up for the servo's lag) the velocity

    v = K e                          where |e| <= b/K^2
    v = sqrt(2 b |e| - b^2/K^2)      elsewhere, with the sign of e,

which is the fastest approach from which the joint can still stop, and at most the
joint's velocity limit. Before the ends of the joint's range, this approach also bounds
a velocity target. Motors saturate at f_max, the joint's effort limit.

A drive for efforts passes the efforts on. It brakes a joint that is faster than its
velocity limit: force = D (v_max - dq), plus an effort against the motion.
"""

from enum import Enum
from math import copysign, inf, sqrt

from station.hw.mujoco.world_joints import WorldJoints

_VELOCITY_GAIN = 1000.0
_POSITION_GAIN = 100.0
_SHARE_OF_EFFORT = 0.3
_SHARE_OF_ACCELERATION = 0.8


class DriveMode(Enum):
    """The quantity that a joint's drive follows."""

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"


class JointDrives:
    """One drive per joint, acting before every step of the world.

    Args:
        joints: The joints in the world, n of them.
        timestep: Time step of the world [s], > 0.

    Attributes:
        velocity_limits: Highest desired speed [rad/s or m/s], shape (n,), infinite at
            first; to be changed in place.
        modes: Mode of each joint, shape (n,); in place.
        position_target: Positions [rad or m], shape (n,); in place.
        velocity_target: Velocities [rad/s or m/s], shape (n,); in place.
        effort_target: Efforts [Nm or N], shape (n,); in place.
    """

    def __init__(self, joints: WorldJoints, timestep: float) -> None:
        count = len(joints.names)
        self._joints = joints
        self._timestep = timestep
        self.velocity_limits = [inf] * count
        self._efforts = [_SHARE_OF_EFFORT * e for e in joints.effort_limits]
        self.modes = [DriveMode.POSITION] * count
        self.position_target = joints.read_positions()
        self.velocity_target = [0.0] * count
        self.effort_target = [0.0] * count
        self._desired_velocity = [0.0] * count
        self._controls = [0.0] * count
        self._damping = [0.0] * count

    def before_step(self) -> None:
        """Write the motors' controls for the coming step."""
        joints = self._joints
        q = joints.read_positions()
        dq = joints.read_velocities()
        bias = joints.read_bias_forces()
        weight = joints.read_compensation()
        inertia = joints.read_inertia()
        controls, damping = self._controls, self._damping
        for i, mode in enumerate(self.modes):
            if mode is DriveMode.EFFORT:
                self._pass_effort_on(i, dq[i], inertia[i])
                continue
            acceleration = self._efforts[i] / inertia[i]
            braking = _SHARE_OF_ACCELERATION * acceleration
            if mode is DriveMode.VELOCITY:
                high = _approach(joints.upper_limits[i] - q[i], braking)
                low = _approach(joints.lower_limits[i] - q[i], braking)
                aim = max(low, min(high, self.velocity_target[i]))
            else:
                aim = _approach(self.position_target[i] - q[i], braking)
            gain = _VELOCITY_GAIN * inertia[i]
            velocity = self._follow(i, aim, acceleration)
            controls[i] = gain * velocity + bias[i] - weight[i]
            damping[i] = gain
        joints.set_controls(controls)
        joints.set_damping(damping)

    def after_reset(self) -> None:
        """Hold the pose to which the world was reset."""
        count = len(self.modes)
        self.position_target[:] = self._joints.read_positions()
        self.velocity_target[:] = [0.0] * count
        self.effort_target[:] = [0.0] * count
        self._desired_velocity[:] = [0.0] * count

    def _pass_effort_on(self, index: int, velocity: float, inertia: float) -> None:
        effort = self.effort_target[index]
        limit = self.velocity_limits[index]
        gain = 0.0
        if velocity > limit:
            gain = _VELOCITY_GAIN * inertia
            effort = min(effort, 0.0) + gain * limit
        elif velocity < -limit:
            gain = _VELOCITY_GAIN * inertia
            effort = max(effort, 0.0) - gain * limit
        self._controls[index] = effort
        self._damping[index] = gain
        self._desired_velocity[index] = velocity

    def _follow(self, index: int, aim: float, acceleration: float) -> float:
        limit = self.velocity_limits[index]
        aim = max(-limit, min(limit, aim))
        step = acceleration * self._timestep
        before = self._desired_velocity[index]
        velocity = max(before - step, min(before + step, aim))
        self._desired_velocity[index] = velocity
        return velocity


def _approach(error: float, braking: float) -> float:
    """Return the velocity [rad/s or m/s] at a distance [rad or m] from the target."""
    knee = braking / (_POSITION_GAIN * _POSITION_GAIN)
    if abs(error) <= knee:
        return _POSITION_GAIN * error
    return copysign(sqrt(braking * (2.0 * abs(error) - knee)), error)
