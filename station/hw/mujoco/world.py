"""The simulated world: owns MuJoCo's model and data, and advances them in time."""

from collections.abc import Sequence
from typing import Protocol

import mujoco

from station.core.errors import StationError
from station.hw.mujoco.stepper import make_stepper
from station.hw.mujoco.world_joints import WorldJoints, joint_position_address

# Sum of squared joint velocities above which a simulation has gone wrong; no machine
# comes near, and MuJoCo itself gives up at 1e10 for a single one.
_MAX_SQUARED_VELOCITY = 1e10


class SimulationDivergedError(StationError, FloatingPointError):
    """The simulated state is not finite any more, or absurdly fast."""

    code = "simulation_diverged"


class WorldActor(Protocol):
    """Something that drives joints of the world, e.g. an arm's own controller."""

    def before_step(self) -> None:
        """Write the controls of the coming step. Control thread; once per step."""

    def after_reset(self) -> None:
        """Begin anew: the world's state has been set from outside."""


class World:
    """A MuJoCo simulation that several robots share.

    Threads: whoever calls `step` is the only one who may touch the world, its data and
    its joints; in the station that is the control thread. `step` and the reading and
    writing of joints neither wait, log, nor give up the interpreter lock, if
    `keeps_interpreter_lock` says so.

    Args:
        model: The compiled model; kept, and changed by `WorldJoints.set_servo`.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        self.timestep: float = float(model.opt.timestep)
        self._advance, self.keeps_interpreter_lock = make_stepper(model, self.data)
        self._qvel = self.data.qvel
        self._actors: list[WorldActor] = []
        self._initial_qpos: list[float] = self.data.qpos.tolist()
        self._step_count = 0
        mujoco.mj_forward(model, self.data)

    @property
    def time(self) -> float:
        """Simulated time since the last reset [s]."""
        return float(self.data.time)

    @property
    def step_count(self) -> int:
        """Number of steps made since the world exists; a reset does not change it."""
        return self._step_count

    def add_actor(self, actor: WorldActor) -> None:
        """Let `actor` act before every step, after those added before it."""
        self._actors.append(actor)

    def joints(self, names: Sequence[str]) -> WorldJoints:
        """Return the view on some joints, in the order of `names`.

        Raises:
            HardwareInterfaceError: A joint is not in the world, has more than one
                degree of freedom, or has no motor.
        """
        return WorldJoints(self.model, self.data, names)

    def step(self) -> None:
        """Let every actor act, then advance by one time step.

        Raises:
            SimulationDivergedError: The state is not usable any more; `reset` it.
        """
        for actor in self._actors:
            actor.before_step()
        self._advance()
        self._step_count += 1
        # A single NaN or infinity anywhere makes the comparison fail.
        if not self._qvel.dot(self._qvel) < _MAX_SQUARED_VELOCITY:
            raise SimulationDivergedError(
                f"the simulation diverged at {self.time:.3f} s: a joint velocity is "
                "not finite or impossibly high",
                remedy="reset the simulation; then lower gains or commands",
            )

    def reset(self, positions: dict[str, float] | None = None) -> None:
        """Set time and velocities to zero and the joints to a pose.

        Args:
            positions: Joint name to position [rad or m]; joints that are not named
                keep the position of the last reset, at first that of the model.

        Raises:
            HardwareInterfaceError: A joint is not in the world.
        """
        for name, position in (positions or {}).items():
            self._initial_qpos[joint_position_address(self.model, name)] = position
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._initial_qpos
        mujoco.mj_forward(self.model, self.data)
        for actor in self._actors:
            actor.after_reset()
