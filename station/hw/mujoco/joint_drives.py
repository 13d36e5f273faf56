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

from enum import IntEnum
from math import inf

from station.hw.mujoco import drives as kernel
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import Block, put

_PARTS = (
    "mode",
    "position_target",
    "velocity_target",
    "effort_target",
    "velocity_limit",
    "effort_limit",
    "lower_limit",
    "upper_limit",
    "desired_velocity",
)


class DriveMode(IntEnum):
    """The quantity that a joint's drive follows."""

    POSITION = kernel.POSITION
    VELOCITY = kernel.VELOCITY
    EFFORT = kernel.EFFORT


class JointDrives:
    """One drive per joint, acting before every step of the world.

    Args:
        joints: The joints in the world, n of them.
        timestep: Time step of the world [s], > 0.

    Attributes:
        velocity_limits: Highest desired speed [rad/s or m/s], shape (n,), infinite at
            first; to be changed in place.
        modes: Numbers of `DriveMode`, shape (n,); in place.
        position_target: Positions [rad or m], shape (n,); in place.
        velocity_target: Velocities [rad/s or m/s], shape (n,); in place.
        effort_target: Efforts [Nm or N], shape (n,); in place.
        preparation: Writes the motors' controls for the coming step.
    """

    def __init__(self, joints: WorldJoints, timestep: float) -> None:
        count = len(joints.names)
        block = Block(dict.fromkeys(_PARTS, count))
        put(block["velocity_limit"], [inf] * count)
        put(block["effort_limit"], joints.effort_limits)
        put(block["lower_limit"], joints.lower_limits)
        put(block["upper_limit"], joints.upper_limits)
        put(block["position_target"], joints.read_positions())
        self._joints = joints
        self._desired_velocity = block["desired_velocity"]
        self.velocity_limits = block["velocity_limit"]
        self.modes = block["mode"]
        self.position_target = block["position_target"]
        self.velocity_target = block["velocity_target"]
        self.effort_target = block["effort_target"]
        own = {name: block[name] for name in _PARTS}
        self.preparation = kernel.Drives(joints.memory, joints.places, own, timestep)

    def after_reset(self) -> None:
        """Hold the pose to which the world was reset."""
        zeros = [0.0] * len(self.modes)
        put(self.position_target, self._joints.read_positions())
        put(self.velocity_target, zeros)
        put(self.effort_target, zeros)
        put(self._desired_velocity, zeros)
