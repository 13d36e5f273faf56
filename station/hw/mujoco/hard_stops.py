"""Mechanical stops for joints that are too fast for MuJoCo's own stops.

MuJoCo notices only after a step that a joint has passed the end of its range, and then
takes about two steps to stop the joint: at 20 rad/s the joint is 1.1 degrees beyond by
then. Where a joint's velocity limit allows more than `FREE_WAY` in a step, the impact
is therefore computed here, before the step. Impulses p between the two links of each
joint that would pass an end slow it down so that it just reaches the end:

    M (dq' - dq) = p,    q_i + dt dq'_i = end_i.

MuJoCo's own stops hold the joint from then on. For a joint whose motor alone can move
it that far in one step, the motor's acceleration is expected to be that of the last
step.
"""

from collections.abc import Mapping, Sequence
from math import inf, radians
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.hw.mujoco.world_joints import find_joint
from station.hw.mujoco.world_step import Preparation

if TYPE_CHECKING:
    from station.hw.mujoco.world import World

FREE_WAY = radians(0.25)
"""Largest way in one step for which MuJoCo's stops suffice [rad]."""
_MOST_SWEEPS = 20
_LEAST_INERTIA = 1e-3


class HardStops(Preparation):
    """The stops of fast rotating joints. Acts in the world before every step.

    Args:
        model: The world's model.
        data: The world's data.
        names: Rotating joints with a range.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]
    ) -> None:
        joints = [find_joint(model, name) for name in names]
        self._model, self._data = model, data
        self._dofs = np.array(model.jnt_dofadr[joints], dtype=np.intp)
        self._places = np.array(model.jnt_qposadr[joints], dtype=np.intp)
        self._lower, self._upper = model.jnt_range[joints].T
        self._timestep = float(model.opt.timestep)
        self._is_strong = _accelerations(model, names) * self._timestep**2 > FREE_WAY
        self._has_strong = bool(self._is_strong.any())
        self._row, self._response = np.zeros((1, model.nv)), np.zeros((1, model.nv))

    @override
    def prepare_step(self) -> None:
        """Slow down the joints that would pass an end of their range."""
        low, high, velocity = self._bounds()
        if not ((velocity > high) | (velocity < low)).any():
            return
        for _ in range(_MOST_SWEEPS):
            beyond = np.maximum(velocity - high, low - velocity)
            worst = int(np.argmax(beyond))
            if beyond[worst] <= 0.0:
                break
            bound = high[worst] if velocity[worst] > high[worst] else low[worst]
            self._change(int(self._dofs[worst]), float(bound - velocity[worst]))
            velocity = self._data.qvel[self._dofs]

    def _bounds(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the velocities that reach the two ends, and the present ones.

        A joint that stands at an end, or a little beyond, may stay where it is:
        MuJoCo's stop drives it back.
        """
        position = self._data.qpos[self._places]
        low = np.minimum(self._lower - position, 0.0) / self._timestep
        high = np.maximum(self._upper - position, 0.0) / self._timestep
        if self._has_strong:
            # The motors are expected to add as much velocity as in the last step.
            added = self._data.qacc_smooth[self._dofs] * self._timestep
            added[~self._is_strong] = 0.0
            low -= np.minimum(added, 0.0)
            high -= np.maximum(added, 0.0)
        return low, high, self._data.qvel[self._dofs]

    def _change(self, dof: int, change: float) -> None:
        """Change the velocity of one joint by an impulse between its links."""
        self._row[0, dof] = 1.0
        mujoco.mj_solveM(self._model, self._data, self._response, self._row)
        self._row[0, dof] = 0.0
        self._data.qvel += self._response[0] * (change / self._response[0, dof])


def _accelerations(model: mujoco.MjModel, names: Sequence[str]) -> NDArray[np.float64]:
    """Return the largest acceleration that each joint's motor can give [rad/s^2]."""
    found = []
    for name in names:
        motor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
        effort = 0.0 if motor < 0 else float(model.actuator_forcerange[motor, 1])
        dof = int(model.joint(name).dofadr[0])
        found.append(effort / max(float(model.dof_armature[dof]), _LEAST_INERTIA))
    return np.array(found)


def add_hard_stops(world: "World", limits: Mapping[str, float]) -> None:
    """Add stops for the joints of a world for which MuJoCo's own stops are too slow.

    Args:
        world: The world.
        limits: Joint name to velocity limit [rad/s or m/s]; infinite for no limit.
    """
    model = world.model
    fast = [name for name, v in limits.items() if needs_hard_stop(model, name, v)]
    if fast:
        world.add_preparation(HardStops(model, world.data, fast))


def needs_hard_stop(model: mujoco.MjModel, name: str, velocity: float) -> bool:
    """Return whether MuJoCo's own stop is too slow for a joint.

    Args:
        model: The world's model.
        name: A joint.
        velocity: Velocity limit of the joint [rad/s]; infinite for no limit.
    """
    joint = model.joint(find_joint(model, name))
    rotates = int(joint.type[0]) == int(mujoco.mjtJoint.mjJNT_HINGE)
    too_fast = velocity == inf or velocity * float(model.opt.timestep) > FREE_WAY
    return bool(rotates and joint.limited[0] and too_fast)
