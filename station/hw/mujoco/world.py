"""The simulated world: owns MuJoCo's model and data, and advances them in time."""

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Protocol

import mujoco

from station.core.description.urdf import Pose
from station.core.errors import HardwareInterfaceError, suggest
from station.core.geometry.scene import SceneObject
from station.core.hardware.robot_report import SceneObjectReport
from station.hw.mujoco.overspeed_brakes import MAX_SQUARED_VELOCITY, OverspeedBrakes
from station.hw.mujoco.push import AppliedPush, Push
from station.hw.mujoco.stepper import make_stepper
from station.hw.mujoco.world_joints import (
    WorldJoints,
    find_joint,
    joint_position_address,
)
from station.hw.mujoco.world_step import Preparation, WorldStep

# MuJoCo's warnings of the whole process. Without a handler MuJoCo writes warnings to a
# file in the current directory, and the control thread must do no I/O.
_warnings: deque[str] = deque(maxlen=8)


class WorldActor(Protocol):
    """A part that drives joints of the world, e.g. an arm's own controller."""

    def after_reset(self) -> None:
        """Start again from the state of the world, which has been reset."""


class World:
    """A MuJoCo simulation that several robots share.

    If the simulated state is not finite any more, or a velocity is impossibly high, the
    world has diverged. It goes back to the pose of the last reset, and its state and
    time stand still until it is reset. All readings stay finite throughout.

    Threads: only the thread that calls `step` may touch the world, its data and its
    joints; in the station that is the control thread. `step` and the reading and
    writing of joints neither wait nor log. They keep the interpreter lock if
    `keeps_interpreter_lock` is true.

    Args:
        model: The compiled model; kept, and changed by `WorldJoints.set_servo`.
        objects: The objects that were added to the model by `add_object`.

    Attributes:
        step: Lets every actor act, then advances by one time step. A diverged world
            only counts the step.
        stepping: Makes the steps.
        brakes: The brakes that keep joints within their velocity limits.
        pushes: The pushes that act at present, by body.
        diverged_because: Why the world has diverged; None if it has not.
    """

    def __init__(
        self, model: mujoco.MjModel, objects: Sequence[SceneObject] = ()
    ) -> None:
        self.model = model
        self._objects = tuple(one for one in objects if one.solid)
        self.data = mujoco.MjData(model)
        self.timestep: float = float(model.opt.timestep)
        stepper = make_stepper(model, self.data)
        self.keeps_interpreter_lock = stepper.keeps_interpreter_lock
        self._qvel = self.data.qvel
        self._actors: list[WorldActor] = []
        self.brakes = OverspeedBrakes(model, self.data)
        self.stepping = WorldStep(
            stepper.step,
            stepper.addresses,
            self.brakes.speeds,
            self._brake,
            self._count_pushes,
        )
        self.step = self.stepping.make_step
        self._start_qpos: list[float] = self.data.qpos.tolist()
        self._initial_qpos = self._start_qpos
        self.diverged_because: str | None = None
        self.pushes: dict[int, AppliedPush] = {}  # by body
        mujoco.set_mju_user_warning(_warnings.append)
        mujoco.mj_forward(model, self.data)

    @property
    def time(self) -> float:
        """Simulated time since the last reset [s]."""
        return float(self.data.time)

    @property
    def step_count(self) -> int:
        """Number of steps made so far; a reset does not change it."""
        return self.stepping.count

    def add_actor(self, actor: WorldActor, preparation: Preparation) -> None:
        """Let an actor act before every step, after those added before.

        Args:
            actor: Its `after_reset` is called after a reset.
            preparation: Writes the controls of the coming step.
        """
        self._actors.append(actor)
        self.add_preparation(preparation)

    def add_preparation(self, preparation: Preparation) -> None:
        """Add a preparation of every step, after the earlier ones.

        Args:
            preparation: Prepares the coming step. Control thread.
        """
        self.stepping.preparations.append(preparation)

    def joints(self, names: Sequence[str]) -> WorldJoints:
        """Return access to some joints, in the order of `names`.

        Raises:
            HardwareInterfaceError: A joint is not in the world, has more than one
                degree of freedom, or has no motor.
        """
        return WorldJoints(
            self.model,
            self.data,
            names,
            pushes=self.pushes,
            brake_forces=self.brakes.forces,
        )

    def limit_velocities(self, limits: Mapping[str, float]) -> None:
        """Brake joints that are faster than their limit; see `brakes`.

        Args:
            limits: Joint name to highest speed, > 0 [rad/s or m/s]; infinite for no
                limit.

        Raises:
            HardwareInterfaceError: A joint is not in the world.
        """
        self.brakes.set_limits({
            find_joint(self.model, name): limit for name, limit in limits.items()
        })

    def scene(self) -> list[SceneObjectReport]:
        """Return the objects in the world with their present poses."""
        return [_report(thing, self.data) for thing in self._objects]

    def place_object(self, name: str, pose: Pose) -> None:
        """Move an object to another pose, at rest.

        Args:
            name: Name of the object.
            pose: Pose of its middle in the world.

        Raises:
            HardwareInterfaceError: The world has no such object.
        """
        if all(one.name != name for one in self._objects):
            raise HardwareInterfaceError(
                f"The world has no object '{name}'.",
                remedy=suggest(name, [one.name for one in self._objects]),
            )
        body = self.model.body(name)
        if body.jntnum[0]:
            joint = self.data.joint(name)
            joint.qpos[:] = [*pose.xyz, *pose.quaternion]
            joint.qvel[:] = 0.0
        else:
            body.pos[:], body.quat[:] = pose.xyz, pose.quaternion
        mujoco.mj_kinematics(self.model, self.data)

    def push(self, push: Push, steps: int) -> None:
        """Push a body; a new push of the same body replaces the last push.

        Args:
            push: The body, the force and the torque.
            steps: Duration in time steps; 0 ends a push.

        Raises:
            HardwareInterfaceError: The world has no such body.
        """
        applied = AppliedPush(self.model, self.data, push, steps)
        self.pushes[applied.body] = applied
        self.stepping.is_pushed = True

    def end_pushes(self) -> None:
        """End every push."""
        for applied in self.pushes.values():
            applied.end()
        self._forget_pushes()

    def _brake(self) -> None:
        """Brake joints that are too fast; end a simulation that has diverged."""
        # `not … <`, so that a NaN counts as diverged, too.
        if not self._qvel.dot(self._qvel) < MAX_SQUARED_VELOCITY:
            detail = _warnings[-1] if _warnings else "no warning of MuJoCo"
            self.diverged_because = (
                f"the simulation diverged at {self.time:.3f} s: a joint velocity was "
                f"not finite or impossibly high ({detail})"
            )
            self.stepping.stands_still = True
            self._return_to_start()
        else:
            self.brakes.act()
        self.stepping.is_braked = self.brakes.has_acted

    def begin_at(self, positions: Mapping[str, float]) -> None:
        """Let the world start at a pose, and reset it.

        Args:
            positions: Joint name to position [rad or m]; other joints start at the
                positions of the model.

        Raises:
            HardwareInterfaceError: A joint is not in the world; nothing changed.
        """
        self._start_qpos = self._qpos_with(positions)
        self.reset()

    def _qpos_with(self, positions: Mapping[str, float]) -> list[float]:
        qpos = list(self._start_qpos)
        for name, position in positions.items():
            qpos[joint_position_address(self.model, name)] = position
        return qpos

    def reset(self, positions: Mapping[str, float] | None = None) -> None:
        """Set time and velocities to zero and the joints to a pose.

        Args:
            positions: Joint name to position [rad or m]; joints that are not named go
                to their start.

        Raises:
            HardwareInterfaceError: A joint is not in the world; nothing changed.
        """
        self._initial_qpos = self._qpos_with(positions or {})
        self._return_to_start()
        self.diverged_because = None
        self.stepping.stands_still = False
        for actor in self._actors:
            actor.after_reset()

    def _count_pushes(self) -> None:
        for body, applied in list(self.pushes.items()):
            if applied.is_over():
                del self.pushes[body]
        self.stepping.is_pushed = bool(self.pushes)

    def _forget_pushes(self) -> None:
        self.pushes.clear()
        self.stepping.is_pushed = False

    def _return_to_start(self) -> None:
        self._forget_pushes()
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._initial_qpos
        mujoco.mj_forward(self.model, self.data)


def _report(thing: SceneObject, data: mujoco.MjData) -> SceneObjectReport:
    body = data.body(thing.name)
    w, x, y, z = body.xquat.tolist()
    return SceneObjectReport(
        thing.name,
        thing.kind,
        thing.size,
        tuple(body.xpos.tolist()),
        (x, y, z, w),
        thing.mass,
        thing.file,
    )
