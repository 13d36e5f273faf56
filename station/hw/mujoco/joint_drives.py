"""Drive the joints of a simulated robot by forces or by stable servos.

A servo has a desired velocity v_d, and gives the force that keeps it:

    force = D (v_d - dq) + c(q, dq),    D = 1000/s * M_ii(q)

with M_ii the inertia at the joint and c the force against gravity (unless gravity is
compensated) and Coriolis forces. `D dq` is part of MuJoCo's motor, where the integrator
treats it implicitly, so that it is stable for every inertia. v_d changes by at most the
acceleration a = 0.3 f_max / M_ii; the rest of the motor's force is left for the effects
of other joints. v_d approaches the velocity target. For a position target, with K =
100/s, e = q_target - q and b = 0.8 a (less than a because the servo lags), v_d
approaches the velocity

    v = K e                          where |e| <= b/K^2
    v = sqrt(2 b |e| - b^2/K^2)      elsewhere, with the sign of e,

which is the fastest approach from which the joint can still stop, but at most the
joint's velocity limit. Near the ends of the joint's range, this approach also bounds a
velocity target. Motors saturate at f_max, the joint's effort limit.

A drive for efforts passes the efforts on. It brakes a joint that is faster than its
velocity limit: force = D (v_max - dq), plus an effort against the motion.
"""

from enum import IntEnum
from math import inf
from typing import TYPE_CHECKING

from station.hw.mujoco.world_step import Preparation
from station.memory.doubles import Block, put
from station.memory.functions import square_root

if TYPE_CHECKING:
    from station.hw.mujoco.world_joints import WorldJoints

VELOCITY_GAIN = 1000.0
"""Rate at which a drive without limits would follow a velocity [1/s]."""
_QUANTITIES = ("position", "velocity", "effort")
_PARTS = (
    *_QUANTITIES,
    "mode",
    "velocity_limit",
    "effort_limit",
    "lower_limit",
    "upper_limit",
    "desired_velocity",
)


class DriveMode(IntEnum):
    """The quantity that a joint's drive follows."""

    POSITION = 0
    VELOCITY = 1
    EFFORT = 2


# The .pxd declares these as C doubles.
_VELOCITY = float(DriveMode.VELOCITY)
_EFFORT = float(DriveMode.EFFORT)
_VELOCITY_GAIN = VELOCITY_GAIN
_POSITION_GAIN = 100.0
_SHARE_OF_EFFORT = 0.3
_SHARE_OF_ACCELERATION = 0.8


def approach_velocity(error: float, braking: float) -> float:
    """Return the velocity [rad/s or m/s] at which to approach a target.

    Args:
        error: Distance to the target [rad or m].
        braking: Deceleration that is available [rad/s^2 or m/s^2], >= 0.
    """
    knee = braking / (_POSITION_GAIN * _POSITION_GAIN)
    distance = error
    if distance < 0.0:
        distance = -distance
    if distance <= knee:
        return _POSITION_GAIN * error
    root = square_root(braking * (2.0 * distance - knee))
    if error < 0.0:
        return -root
    return root


class JointDrives(Preparation):
    """One drive per joint, acting before every step of the world.

    The joints are in any order: an index says where each one is in the simulator's
    memory.

    Args:
        joints: The joints in the world, n of them.
        timestep: Time step of the world [s], > 0.

    Attributes:
        velocity_limits: Highest desired speed [rad/s or m/s], shape (n,), infinite at
            first; owners change it in place.
        modes: Numbers of `DriveMode`, shape (n,); owners change it in place.
        targets: Positions [rad or m], velocities [rad/s or m/s] and efforts [Nm or N]
            by quantity, shape (n,) each; owners change them in place.
    """

    def __init__(self, joints: "WorldJoints", timestep: float) -> None:
        self.size = count = len(joints.names)
        block = Block(dict.fromkeys(_PARTS, count))
        put(block["velocity_limit"], [inf] * count)
        put(block["effort_limit"], joints.effort_limits)
        put(block["lower_limit"], joints.lower_limits)
        put(block["upper_limit"], joints.upper_limits)
        put(block["position"], joints.read_positions())
        self._joints = joints
        # Python reads these views faster than the ones below, which are for Cython.
        self.velocity_limits = block["velocity_limit"]
        self.modes = block["mode"]
        self.targets = {quantity: block[quantity] for quantity in _QUANTITIES}
        self.mode = block["mode"]
        self.position = block["position"]
        self.velocity = block["velocity"]
        self.effort = block["effort"]
        self.velocity_limit = block["velocity_limit"]
        self.effort_limit = block["effort_limit"]
        self.lower_limit = block["lower_limit"]
        self.upper_limit = block["upper_limit"]
        self.desired = block["desired_velocity"]
        memory, places = joints.memory, joints.places
        self.qpos = memory["qpos"]
        self.qvel = memory["qvel"]
        self.bias = memory["bias"]
        self.weight = memory["weight"]
        self.inertia = memory["inertia"]
        self.control = memory["control"]
        self.damping = memory["damping"]
        self.place_qpos = places["qpos"]
        self.place_dof = places["dof"]
        self.place_inertia = places["inertia"]
        self.place_control = places["control"]
        self.place_damping = places["damping"]
        self.timestep = timestep

    def prepare_step(self) -> None:
        """Write the motors' controls and damping."""
        qvel, inertia, mode = self.qvel, self.inertia, self.mode
        place_dof, place_inertia = self.place_dof, self.place_inertia
        velocity_limit, desired = self.velocity_limit, self.desired
        control, damping = self.control, self.damping
        place_control, place_damping = self.place_control, self.place_damping
        timestep = self.timestep
        for i in range(self.size):
            dof = place_dof[i]
            mass = inertia[place_inertia[i]]
            limit = velocity_limit[i]
            kind = mode[i]
            gain = 0.0
            if kind == _EFFORT:
                velocity = qvel[dof]
                effort = self.effort[i]
                if velocity > limit:
                    gain = _VELOCITY_GAIN * mass
                    if effort > 0.0:
                        effort = 0.0
                    effort = effort + gain * limit
                elif velocity < -limit:
                    gain = _VELOCITY_GAIN * mass
                    if effort < 0.0:
                        effort = 0.0
                    effort = effort - gain * limit
            else:
                gain = _VELOCITY_GAIN * mass
                acceleration = _SHARE_OF_EFFORT * self.effort_limit[i] / mass
                braking = _SHARE_OF_ACCELERATION * acceleration
                q = self.qpos[self.place_qpos[i]]
                if kind == _VELOCITY:
                    velocity = self.velocity[i]
                    bound = approach_velocity(self.upper_limit[i] - q, braking)
                    if not velocity < bound:
                        velocity = bound
                    bound = approach_velocity(self.lower_limit[i] - q, braking)
                    if not velocity > bound:
                        velocity = bound
                else:
                    velocity = approach_velocity(self.position[i] - q, braking)
                if not velocity < limit:
                    velocity = limit
                if not velocity > -limit:
                    velocity = -limit
                step = acceleration * timestep
                before = desired[i]
                if not velocity < before + step:
                    velocity = before + step
                if not velocity > before - step:
                    velocity = before - step
                effort = gain * velocity + self.bias[dof] - self.weight[dof]
            desired[i] = velocity
            control[place_control[i]] = effort
            damping[place_damping[i]] = -gain

    def after_reset(self) -> None:
        """Hold the pose to which the world was reset."""
        zeros = [0.0] * self.size
        put(self.position, self._joints.read_positions())
        put(self.velocity, zeros)
        put(self.effort, zeros)
        put(self.desired, zeros)
