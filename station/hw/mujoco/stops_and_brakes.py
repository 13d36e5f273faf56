"""Stops and brakes that keep simulated joints within their ranges and velocity limits.

*Brakes.* The limits of joint_limits_interface treat one joint at a time, once per
cycle, and only its commands. They cannot know the effect of other joints, contacts and
late torques: when all joints of an arm are commanded to their limits at once, a joint
can be thrown beyond its limit although its own motor gives no torque, or brakes as hard
as it can. Real drives have a protection of their own against that, and so do these
joints.

After a step, joints that are faster than `OVERSPEED` times their limit are slowed down
to exactly that by impulses p between their two links, against the motion:

    M (dq' - dq) = p,    |dq'_i| <= OVERSPEED * limit_i,    p_i = 0 or against dq'_i

with the inertia M of that step; the positions of the step are corrected accordingly.
The brakes only remove energy. Within the limits the brakes do nothing, so they never
change a motion that respects the limits. Mimic joints have brakes of their own.

Slowing one joint down moves other joints, and can carry one of them past its mechanical
stop. Therefore the stops give impulses, too: in that step a joint with a range goes at
most to its end, or not further beyond it,

    q_i + dt dq'_i >= min(q_i, lower_i),    q_i + dt dq'_i <= max(q_i, upper_i)

with the positions q before the step. Forces of the stops do not count as brake forces.

*Stops.* MuJoCo notices only after a step that a joint has passed the end of its range,
and then takes about two steps to stop the joint: at 20 rad/s the joint is 1.1 degrees
beyond by then. Where a joint's velocity limit allows more than `FREE_WAY` in a step,
the impact is therefore computed here, before the step. Impulses p between the two links
of each joint that would pass an end slow it down so that it just reaches the end:

    M (dq' - dq) = p,    q_i + dt dq'_i = end_i.

MuJoCo's own stops hold the joint from then on. For a joint whose motor alone can move
it that far in one step, the motor's acceleration is expected to be that of the last
step.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import copysign, inf, radians, sqrt
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.hardware.limits.joint_limits_handle import Clamp, ClampReason
from station.core.hardware.robot_report import ClampReport
from station.hw.mujoco.world_joints import find_joint
from station.hw.mujoco.world_step import Preparation, SpeedCheck
from station.memory.doubles import as_doubles

if TYPE_CHECKING:
    from station.hw.mujoco.world import World

OVERSPEED = 1.015
"""Ratio of a joint's velocity to its limit above which the joint is braked."""
BRAKES = "simulated brakes"
"""Name that stands for a hardware interface in a report of clamps by brakes."""
MAX_SQUARED_VELOCITY = 1e10
"""Sum of squared joint velocities above which a simulation has diverged. No machine
reaches such velocities; MuJoCo itself gives up at 1e10 for a single velocity."""
_SINGLE_DOF = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
_MOST_SWEEPS = 200
# Accuracy of the impulses, relative to the limit.
_TOLERANCE = 1e-6
FREE_WAY = radians(0.25)
"""Largest way in one step for which MuJoCo's stops suffice [rad]."""
_MOST_SWEEPS_OF_STOPS = 20
_LEAST_INERTIA = 1e-3


class OverspeedBrakes:
    """The brakes of all joints of a world. Control thread only.

    Args:
        model: The world's model.
        data: The world's data; `act` changes them.

    Attributes:
        forces: Mean force of the brakes in the last step [Nm or N], one per degree of
            freedom of the model, shape (nv,); in place.
        braked_steps: Steps in which a brake acted.
        counts: Steps in which each degree of freedom was braked, shape (nv,).
        asked: Velocities before the brakes acted the last time, shape (nv,).
        has_acted: Whether a brake acted in the last step.
        speeds: Checks that all velocities are possible and within their limits; False
            does not mean that a joint is too fast.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model = model
        self._data = data
        self._qvel: NDArray[np.float64] = data.qvel
        self._bounds = np.full(model.nv, inf)
        self._shares = np.zeros(model.nv)  # 1 / bound
        self._relative = np.zeros(model.nv)
        # As `_shares`, but joints without a limit have a share, too, so that one sum
        # shows an impossible velocity of any joint.
        self._sane = np.full(model.nv, 1.0 / sqrt(MAX_SQUARED_VELOCITY))
        self.speeds = SpeedCheck(as_doubles(data.qvel), as_doubles(self._sane))
        self._position_of_dof = np.full(model.nv, -1, dtype=np.intp)
        single = np.isin(model.jnt_type, _SINGLE_DOF)
        self._position_of_dof[model.jnt_dofadr[single]] = model.jnt_qposadr[single]
        stopped = np.flatnonzero(single & (model.jnt_limited != 0))
        self._stopped: NDArray[np.intp] = model.jnt_dofadr[stopped].astype(np.intp)
        self._ends: NDArray[np.float64] = model.jnt_range[stopped].T
        self.has_acted = False
        self.forces = np.zeros(model.nv)
        self.braked_steps = 0
        self.counts = np.zeros(model.nv, dtype=np.int64)
        self.asked = np.zeros(model.nv)

    def clamps(self, names: Iterable[str]) -> list[ClampReport]:
        """Return those of the given joints that were braked. Any thread.

        Args:
            names: Joints with one degree of freedom.
        """
        reports = []
        for name in names:
            dof = int(self._model.joint(name).dofadr[0])
            if count := int(self.counts[dof]):
                asked = float(self.asked[dof])
                given = copysign(float(self._bounds[dof]), asked)
                last = Clamp(name, asked, given, ClampReason.VELOCITY)
                reports.append(ClampReport(BRAKES, count, last))
        return reports

    def set_limits(self, limits: Mapping[int, float]) -> None:
        """Set the velocity limits of some joints.

        Args:
            limits: Joint with one degree of freedom, by its number in the model, to its
                velocity limit, > 0 [rad/s or m/s]; infinite for none.
        """
        for joint, limit in limits.items():
            dof = int(self._model.jnt_dofadr[joint])
            self._bounds[dof] = OVERSPEED * limit
            self._shares[dof] = 1.0 / self._bounds[dof]
            self._sane[dof] = max(1.0 / sqrt(MAX_SQUARED_VELOCITY), self._shares[dof])
        self.speeds.take_limits()

    def act(self) -> None:
        """Slow down the joints that were too fast at the end of the last step."""
        if self.has_acted:
            self.forces[:] = 0.0
            self.has_acted = False
        relative = self._relative
        np.multiply(self._qvel, self._shares, out=relative)
        # The sum is a quick test that usually suffices. Both tests are false for a NaN,
        # which the world reports as a divergence.
        if not relative.dot(relative) > 1.0 or not np.abs(relative).max() > 1.0:
            return
        fast = np.abs(relative) > 1.0
        self.asked[fast] = self._qvel[fast]
        self.counts += fast
        low, high = self._bounds_with_stops()
        held = np.flatnonzero((low > -inf) | (high < inf))
        response = self._response(held)
        scale = np.where(self._bounds < inf, self._bounds, 1.0)
        impulses = _find_impulses(
            self._qvel[held], (low[held], high[held], scale[held]), response[:, held]
        )
        change = impulses @ response
        self._qvel += change
        timestep = self._model.opt.timestep
        # The integrator is semi-implicit: it moves with the velocity after the step.
        dofs = np.flatnonzero(change)
        places = self._position_of_dof[dofs]
        if places.size and places.min() < 0:
            # A floating base is turned by a quaternion, not by a sum.
            mujoco.mj_integratePos(self._model, self._data.qpos, change, timestep)
        else:
            self._data.qpos[places] += timestep * change[dofs]
        # An impulse slows its joint down, or comes from the stop at the joint's end.
        is_stop = np.where(impulses < 0.0, high[held], -low[held]) < self._bounds[held]
        self.forces[held] = np.where(is_stop, 0.0, impulses / timestep)
        self.has_acted = True
        self.braked_steps += 1

    def _bounds_with_stops(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lowest and highest allowed velocity of each degree of freedom."""
        low, high = -self._bounds, self._bounds.copy()
        stopped, timestep = self._stopped, self._model.opt.timestep
        before = self._data.qpos[self._position_of_dof[stopped]]
        before = before - timestep * self._qvel[stopped]
        lower, upper = self._ends
        to_lower = np.minimum(lower - before, 0.0) / timestep
        to_upper = np.maximum(upper - before, 0.0) / timestep
        low[stopped] = np.maximum(low[stopped], to_lower)
        high[stopped] = np.minimum(high[stopped], to_upper)
        return low, high

    def _response(self, dofs: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the velocities that unit impulses cause, shape (len(dofs), nv)."""
        rows = np.zeros((len(dofs), self._model.nv))
        rows[np.arange(len(dofs)), dofs] = 1.0
        solved = np.empty_like(rows)
        mujoco.mj_solveM(self._model, self._data, solved, rows)
        return solved


def _find_impulses(
    velocities: NDArray[np.float64],
    bounds: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    response: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the impulses that bring velocities within their bounds, shape (n,).

    Computed joint by joint with the impulses of the other joints fixed, until no
    impulse changes (coordinate descent on a convex function).

    Args:
        velocities: Velocities without impulses [rad/s or m/s], shape (n,).
        bounds: Least velocities, <= 0; largest velocities, >= 0; and scales for the
            accuracy, > 0; shape (n,) each.
        response: Velocities that unit impulses cause, symmetric, shape (n, n).
    """
    velocity = velocities.copy()
    impulses = np.zeros_like(velocity)
    limits = list(zip(*(bound.tolist() for bound in bounds), strict=True))
    for _ in range(_MOST_SWEEPS):
        worst = 0.0
        for i, (low, high, scale) in enumerate(limits):
            own = response[i, i]
            free = velocity[i] - own * impulses[i]
            wanted = (min(max(free, low), high) - free) / own
            change = wanted - impulses[i]
            if change:
                velocity += change * response[i]
                impulses[i] = wanted
                worst = max(worst, abs(change * own) / scale)
        if worst < _TOLERANCE:
            break
    return impulses


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
        for _ in range(_MOST_SWEEPS_OF_STOPS):
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
