"""Drive the joints of a simulated robot: by force, or by servos that are stable.

A servo turns its target into a velocity and gives the force that keeps it:

    v = clip(100/s * (q_target - q), -v_max, v_max)     or the velocity target
    force = D (v - dq) + c(q, dq),    D = 1000/s * M_ii(q)

with M_ii the inertia at the joint and c what gravity (unless it is compensated) and
Coriolis forces need. `D dq` lives in MuJoCo's motor, where the integrator treats it
implicitly. So a servo reaches its target without overshoot, never wants more than the
joint's velocity limit, and is stable for every inertia. Motors saturate at the joint's
effort limit.
"""

from enum import Enum
from math import inf

from station.hw.mujoco.world_joints import WorldJoints

_VELOCITY_GAIN = 1000.0
_POSITION_GAIN = 100.0


class DriveMode(Enum):
    """What the target of a joint's drive is."""

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"


class JointDrives:
    """One drive per joint, acting before every step of the world.

    Args:
        joints: The joints in the world, n of them.
        velocity_limits: Highest speed of a position servo [rad/s or m/s], shape (n,);
            infinite where unlimited.

    Attributes:
        modes: Mode of each joint, shape (n,); to be changed in place.
        position_target: [rad or m], shape (n,); in place, as the next two.
        velocity_target: [rad/s or m/s], shape (n,).
        effort_target: [Nm or N], shape (n,).
    """

    def __init__(self, joints: WorldJoints, velocity_limits: list[float]) -> None:
        count = len(joints.names)
        self._joints = joints
        self._velocity_limits = [v if v > 0.0 else inf for v in velocity_limits]
        self.modes = [DriveMode.POSITION] * count
        self.position_target = joints.read_positions()
        self.velocity_target = [0.0] * count
        self.effort_target = [0.0] * count
        self._controls = [0.0] * count
        self._damping = [0.0] * count

    def before_step(self) -> None:
        """Write the motors' controls for the coming step."""
        joints = self._joints
        q = joints.read_positions()
        bias = joints.read_bias_forces()
        weight = joints.read_compensation()
        inertia = joints.read_inertia()
        controls, damping = self._controls, self._damping
        for i, mode in enumerate(self.modes):
            if mode is DriveMode.EFFORT:
                controls[i] = self.effort_target[i]
                damping[i] = 0.0
                continue
            if mode is DriveMode.VELOCITY:
                velocity = self.velocity_target[i]
            else:
                velocity = _POSITION_GAIN * (self.position_target[i] - q[i])
                limit = self._velocity_limits[i]
                velocity = max(-limit, min(limit, velocity))
            gain = _VELOCITY_GAIN * inertia[i]
            controls[i] = gain * velocity + bias[i] - weight[i]
            damping[i] = gain
        joints.set_controls(controls)
        joints.set_damping(damping)

    def after_reset(self) -> None:
        """Stay where the world was set to."""
        self.position_target[:] = self._joints.read_positions()
        self.velocity_target[:] = [0.0] * len(self.modes)
        self.effort_target[:] = [0.0] * len(self.modes)
