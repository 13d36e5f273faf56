"""The drives of simulated joints: the controls of their motors before a step.

The formulas stand in `station.hw.mujoco.joint_drives`. The joints are in any order: an
index says where each one is in the simulator's memory.
"""

from collections.abc import Mapping

from station.hw.mujoco.world_step import Preparation
from station.memory.doubles import Doubles
from station.memory.functions import square_root

POSITION = 0
"""Mode of a joint that follows positions."""
VELOCITY = 1
"""Mode of a joint that follows velocities."""
EFFORT = 2
"""Mode of a joint that passes efforts on."""

VELOCITY_GAIN = 1000.0
"""Rate at which a drive without limits would follow a velocity [1/s]."""

# As C numbers, by the .pxd.
_VELOCITY = VELOCITY
_EFFORT = EFFORT
_VELOCITY_GAIN = VELOCITY_GAIN
_POSITION_GAIN = 100.0
_SHARE_OF_EFFORT = 0.3
_SHARE_OF_ACCELERATION = 0.8


def approach_velocity(error: float, braking: float) -> float:
    """Return the velocity [rad/s or m/s] at a distance from the target.

    Args:
        error: Distance to the target [rad or m].
        braking: Deceleration that the joint can be braked with, >= 0.
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


class Drives(Preparation):
    """The drives of n joints.

    Args:
        simulated: The simulator's memory by name: `qpos`, `qvel`, `bias`, `weight`,
            `inertia`, `control` and `damping` (the motors' velocity coefficients).
        places: Where each joint is in it, by the same names but for `qvel`, `bias` and
            `weight`, which share `dof`; shape (n,) each.
        own: The drives' doubles by name, shape (n,): `mode`, `position_target`,
            `velocity_target`, `effort_target`, `velocity_limit`, `effort_limit`,
            `lower_limit`, `upper_limit` and `desired_velocity`, which is remembered.
        timestep: Time step of the world [s], > 0.
    """

    def __init__(
        self,
        simulated: Mapping[str, Doubles],
        places: Mapping[str, "memoryview[int]"],
        own: Mapping[str, Doubles],
        timestep: float,
    ) -> None:
        self.qpos = simulated["qpos"]
        self.qvel = simulated["qvel"]
        self.bias = simulated["bias"]
        self.weight = simulated["weight"]
        self.inertia = simulated["inertia"]
        self.control = simulated["control"]
        self.damping = simulated["damping"]
        self.place_qpos = places["qpos"]
        self.place_dof = places["dof"]
        self.place_inertia = places["inertia"]
        self.place_control = places["control"]
        self.place_damping = places["damping"]
        self.mode = own["mode"]
        self.position_target = own["position_target"]
        self.velocity_target = own["velocity_target"]
        self.effort_target = own["effort_target"]
        self.velocity_limit = own["velocity_limit"]
        self.effort_limit = own["effort_limit"]
        self.lower_limit = own["lower_limit"]
        self.upper_limit = own["upper_limit"]
        self.desired_velocity = own["desired_velocity"]
        self.size = len(own["mode"])
        self.timestep = timestep

    def prepare_step(self) -> None:
        """Write the motors' controls and damping."""
        qvel, inertia, mode = self.qvel, self.inertia, self.mode
        place_dof, place_inertia = self.place_dof, self.place_inertia
        velocity_limit, desired = self.velocity_limit, self.desired_velocity
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
                effort = self.effort_target[i]
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
                    velocity = self.velocity_target[i]
                    bound = approach_velocity(self.upper_limit[i] - q, braking)
                    if not velocity < bound:
                        velocity = bound
                    bound = approach_velocity(self.lower_limit[i] - q, braking)
                    if not velocity > bound:
                        velocity = bound
                else:
                    velocity = approach_velocity(self.position_target[i] - q, braking)
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
