"""The simulated world: owns MuJoCo's model and data, pushes and advances them in time.

MuJoCo's Python binding releases the interpreter lock in `mj_step`. A busy thread then
takes the lock, and the control loop waits for it longer than the step lasts. The same C
function keeps the lock if it is called through `ctypes.PyDLL`.
"""

import ctypes
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import mujoco
import numpy as np

from station.core.description.urdf import Pose
from station.core.errors import HardwareInterfaceError, suggest
from station.core.geometry.scene import SceneObject
from station.core.hardware.robot_report import SceneObjectReport
from station.hw.mujoco.stops_and_brakes import MAX_SQUARED_VELOCITY, OverspeedBrakes
from station.hw.mujoco.world_joints import (
    WorldJoints,
    find_joint,
    joint_position_address,
)
from station.hw.mujoco.world_step import Preparation, WorldStep

WORLD = "world"
"""Name of the world's own axes."""
# MuJoCo's warnings of the whole process. Without a handler MuJoCo writes warnings to a
# file in the current directory, and the control thread must do no I/O.
_warnings: deque[str] = deque(maxlen=8)
_MAX_STEPS_COMPARED = 2


@dataclass(frozen=True, slots=True)
class Push:
    """A force and a torque on a body.

    Attributes:
        body: Name of a link that has mass, or of an object.
        force: Force [N], shape (3,).
        torque: Torque [Nm], shape (3,).
        frame: Frame in whose axes force and torque are given: the world, or a body,
            with which they turn.
        point: Point of application, in the body's frame [m], shape (3,); None
            for its centre of mass.
    """

    body: str
    force: tuple[float, ...]
    torque: tuple[float, ...] = (0.0, 0.0, 0.0)
    frame: str = WORLD
    point: tuple[float, ...] | None = None


class AppliedPush:
    """A push that lasts for some steps. For the thread that steps the world.

    Args:
        model: The world's model.
        data: The world's data.
        push: The push.
        steps: Duration in time steps, >= 0.

    Attributes:
        left: Number of remaining time steps.

    Raises:
        HardwareInterfaceError: The world has no such body.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, push: Push, steps: int
    ) -> None:
        self.body = _find_body(model, push.body)
        self._frame = 0 if push.frame == WORLD else _find_body(model, push.frame)
        self._data = data
        self._force, self._torque = np.array(push.force), np.array(push.torque)
        self._point = None if push.point is None else np.array(push.point)
        self.left = steps
        # Only a push that turns or moves with a body is computed anew in each step.
        self._is_constant = not self._frame and self._point is None
        self._apply()

    def is_over(self) -> bool:
        """Count a step; return whether the push has ended."""
        if self.left <= 0:
            self.end()
            return True
        self.left -= 1
        if not self._is_constant:
            self._apply()
        return False

    def end(self) -> None:
        """Remove the force and the torque from the body."""
        self._data.xfrc_applied[self.body] = 0.0

    def _apply(self) -> None:
        data = self._data
        axes = data.xmat[self._frame].reshape(3, 3)
        force, torque = axes @ self._force, axes @ self._torque
        if self._point is not None:
            turned = data.xmat[self.body].reshape(3, 3) @ self._point
            arm = data.xpos[self.body] + turned - data.xipos[self.body]
            torque = torque + np.cross(arm, force)
        data.xfrc_applied[self.body] = [*force, *torque]


def as_push(
    body: str,
    force: Sequence[float],
    torque: Sequence[float],
    *,
    frame: str = WORLD,
    point: Sequence[float] | None = None,
) -> Push:
    """Return a push with copies of the numbers."""
    at = None if point is None else tuple(point)
    return Push(body, tuple(force), tuple(torque), frame, at)


def _find_body(model: mujoco.MjModel, name: str) -> int:
    number: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if number <= 0:
        known = [model.body(i).name for i in range(1, model.nbody)]
        raise HardwareInterfaceError(
            f"The simulated world has no body {name!r}.",
            remedy=f"Choose among {', '.join(known) or 'none'}.",
            details={"body": name},
        )
    return number


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


class Stepper(NamedTuple):
    """The implementation of a simulation step.

    Attributes:
        step: Makes one step.
        addresses: Addresses of the C function that makes the same step and keeps the
            lock, and of its model and data; zeros without such a function.
    """

    step: Callable[[], None]
    addresses: tuple[int, int, int] = (0, 0, 0)

    @property
    def keeps_interpreter_lock(self) -> bool:
        """Return whether other threads are kept waiting during a step."""
        return self.addresses[0] != 0


def make_stepper(model: mujoco.MjModel, data: mujoco.MjData) -> Stepper:
    """Return a function that advances `data` by a step.

    The direct call is used only if a test shows that its results equal those of the
    binding bit for bit; otherwise the binding is used.

    Args:
        model: The model.
        data: Data of the model. Both must outlive the returned function.
    """
    binding = partial(mujoco.mj_step, model, data)
    function = _find_function("mj_step")
    addresses = _addresses(model, data)
    if function is None or addresses is None or not _agrees(function, model):
        return Stepper(binding)
    places = ctypes.cast(function, ctypes.c_void_p), *addresses
    numbers = [place.value or 0 for place in places]
    return Stepper(partial(function, *addresses), (numbers[0], numbers[1], numbers[2]))


def direct_function(
    name: str, model: mujoco.MjModel, data: mujoco.MjData
) -> Callable[[], None]:
    """Return a MuJoCo function of model and data that keeps the interpreter lock.

    If the library cannot be called directly, the function of the binding is returned.

    Args:
        name: Name of the function in C, e.g. `mj_fwdPosition`.
        model: The model.
        data: Data of the model. Both must outlive the function.
    """
    function = _find_function(name)
    addresses = _addresses(model, data)
    if function is None or addresses is None:
        return partial(getattr(mujoco, name), model, data)
    return partial(function, *addresses)


def _find_function(name: str) -> Any:  # noqa: ANN401 - a function of ctypes, or None
    directory = Path(mujoco.__file__).parent
    for path in sorted(directory.glob("libmujoco*")):
        try:
            library = ctypes.PyDLL(str(path))
            library.mj_version.restype = ctypes.c_int
            if library.mj_version() != mujoco.mj_version():
                continue
            function: Any = getattr(library, name)
        except (OSError, AttributeError):
            # The library is missing, or has no function of that name.
            continue
        function.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        function.restype = None
        return function
    return None


def _addresses(
    model: mujoco.MjModel, data: mujoco.MjData
) -> tuple[ctypes.c_void_p, ctypes.c_void_p] | None:
    addresses = (getattr(model, "_address", None), getattr(data, "_address", None))
    if not all(isinstance(address, int) for address in addresses):
        return None
    return ctypes.c_void_p(addresses[0]), ctypes.c_void_p(addresses[1])


def _agrees(function: Callable[..., None], model: mujoco.MjModel) -> bool:
    direct, reference = mujoco.MjData(model), mujoco.MjData(model)
    addresses = _addresses(model, direct)
    if addresses is None:
        return False
    for _ in range(_MAX_STEPS_COMPARED):
        function(*addresses)
        mujoco.mj_step(model, reference)
    return _state(direct) == _state(reference)


def _state(data: mujoco.MjData) -> tuple[float, list[float], list[float]]:
    return float(data.time), data.qpos.tolist(), data.qvel.tolist()
