"""Deviations of a simulated robot from its model: load, friction, delay, noise."""

import math
from collections import deque
from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from station.core.errors import suggest
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.hw.mujoco.shared_world import SharedWorld
from station.hw.mujoco.world import World
from station.trials.errors import ExperimentError, UnknownParameterError

_COMMANDED = (EffortJointInterface, PositionJointInterface, VelocityJointInterface)
_DENSITY = 2000.0
"""Density of a load, which is a ball [kg/m^3]."""
_SMALLEST_SHARE = 0.1
"""A body that weighs less than this share of its parent, e.g. a finger, carries no
load."""


def world_of(hw: RobotHW) -> World:
    """Return the MuJoCo world of a robot.

    Raises:
        ExperimentError: The robot is not simulated with MuJoCo.
    """
    found = hw.simulated_world()
    if not isinstance(found, SharedWorld):
        raise ExperimentError(
            f"The robot {type(hw).__name__} is not simulated with MuJoCo.",
            remedy="Choose a configuration with franka_hw/FrankaHW or "
            "mujoco_hw/MujocoRobotHW.",
        )
    return found.world


class Mechanics:
    """Changes load, friction and damping of a world, and can restore them.

    Call the methods before a reset of the world: a model must not change during a
    motion.

    Args:
        world: The world, without any changes yet.
        joints: The joints that the robot commands, n >= 1 of them.
    """

    def __init__(self, world: World, joints: Sequence[str]) -> None:
        self._model = model = world.model
        # Separate data, because computing the constants of the model writes into the
        # data.
        self._scratch = mujoco.MjData(model)
        self._dofs = {
            name: int(model.jnt_dofadr[model.joint(name).id]) for name in joints
        }
        self._carrier = _carrier(
            model, int(model.jnt_bodyid[model.joint(joints[-1]).id])
        )
        self._pristine = {
            name: np.copy(value)
            for name in dir(model)
            if name.startswith(("body_", "dof_"))
            and isinstance(value := getattr(model, name), np.ndarray)
        }

    @property
    def carrier(self) -> str:
        """Name of the body that carries the load."""
        return str(self._model.body(self._carrier).name)

    def restore(self) -> None:
        """Restore the original values of the model, bit for bit."""
        for name, value in self._pristine.items():
            getattr(self._model, name)[...] = value

    def change(
        self, load: float, friction: Mapping[str, float], damping: Mapping[str, float]
    ) -> None:
        """Change the original model; call `restore` first.

        Args:
            load: Mass at the centre of mass of the carrier [kg], >= 0. The robot and
                its gravity compensation do not take it into account.
            friction: Coulomb friction by joint, added to the model's [Nm or N], >= 0.
            damping: Viscous damping by joint, added to the model's [Nm s/rad or N s/m],
                >= 0.

        Raises:
            UnknownParameterError: A joint is not one of the robot's.
        """
        model, carrier = self._model, self._carrier
        for values, target in (
            (friction, model.dof_frictionloss),
            (damping, model.dof_damping),
        ):
            for joint, value in values.items():
                target[self._dof(joint)] += value
        if load > 0.0:
            before = float(model.body_mass[carrier])
            radius = (3.0 * load / (4.0 * math.pi * _DENSITY)) ** (1.0 / 3.0)
            model.body_mass[carrier] = before + load
            model.body_inertia[carrier] += 0.4 * load * radius**2
            # Gravity compensation must still carry the original weight only.
            model.body_gravcomp[carrier] *= before / (before + load)
        if load > 0.0 or any(friction.values()) or any(damping.values()):
            mujoco.mj_setConst(model, self._scratch)

    def check_joint(self, joint: str) -> None:
        """Refuse a joint that is not one of the robot's.

        Raises:
            UnknownParameterError: The robot has no such joint.
        """
        if joint not in self._dofs:
            raise UnknownParameterError(
                f"The robot has no joint '{joint}'.",
                remedy=suggest(joint, self._dofs),
                details={"joint": joint},
            )

    def _dof(self, joint: str) -> int:
        """Return the index of a joint's velocity.

        Raises:
            UnknownParameterError: The joint is not one of the robot's.
        """
        self.check_joint(joint)
        return self._dofs[joint]


def _carrier(model: mujoco.MjModel, body: int) -> int:
    """Return the last heavy body of a chain: a hand rather than the last link."""
    while True:
        children = [
            i
            for i in range(model.nbody)
            if model.body_parentid[i] == body and i != body
        ]
        masses = {child: float(model.body_mass[child]) for child in children}
        heaviest = max(masses, key=masses.__getitem__, default=body)
        smallest = _SMALLEST_SHARE * float(model.body_mass[body])
        if heaviest == body or masses[heaviest] <= smallest:
            return body
        body = heaviest


class CommandDelay:
    """Delays the commands of joints by some cycles on their way to the robot.

    Only the way from the controllers to the robot is delayed, not the arm's own
    control, e.g. of its pose.

    Args:
        loop: The robot's loop; with a delay it sends older commands.
    """

    def __init__(self, loop: ControlLoop) -> None:
        hw = loop.hw
        self._cycles = 0
        self._slots = [
            (handle.command_storage, handle.command_index)
            for kind in _COMMANDED
            if (interface := hw.get(kind)) is not None
            for handle in interface.handles()
        ]
        self._line: deque[list[float]] = deque()
        self._hw = hw
        self._write = hw.write

    def begin(self, cycles: int) -> None:
        """Begin a trial with no commands on their way.

        Args:
            cycles: The delay in cycles, >= 0.
        """
        self._cycles = cycles
        self._line.clear()
        # Without a delay the robot's own method does the same, and is quicker.
        self._hw.write = self.write if cycles else self._write  # type: ignore[method-assign]

    def write(self, time: float, period: float) -> None:
        """Send the delayed commands to the robot.

        Args:
            time: Station time of this cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        commands = [storage[index] for storage, index in self._slots]
        self._line.append(commands)
        is_full = len(self._line) > self._cycles
        self._put(self._line.popleft() if is_full else self._line[0])
        self._write(time, period)
        self._put(commands)  # controllers must find their own commands

    def _put(self, commands: list[float]) -> None:
        for (storage, index), command in zip(self._slots, commands, strict=True):
            storage[index] = command


class MeasurementNoise:
    """Adds Gaussian noise to the readings of a robot's joints.

    Controllers, limits and the record see the noise; the motors and the supervision
    inside of a simulated arm do not.

    Args:
        loop: The robot's loop, which adds the noise to its readings.
    """

    def __init__(self, loop: ControlLoop) -> None:
        interface = loop.hw.get(JointStateInterface)
        self._handles = interface.handles() if interface else []
        self._position = self._velocity = 0.0
        self._random = np.random.default_rng(0)
        self._hw = loop.hw
        self._read = loop.hw.read

    def begin(self, position: float, velocity: float, seed: int) -> None:
        """Begin a trial.

        Args:
            position: Standard deviation of positions [rad or m], >= 0.
            velocity: Standard deviation of velocities [rad/s or m/s], >= 0.
            seed: Seed of the noise, >= 0.
        """
        self._position, self._velocity = position, velocity
        self._random = np.random.default_rng(seed)
        is_silent = position == velocity == 0.0
        self._hw.read = self._read if is_silent else self.read  # type: ignore[method-assign]

    def read(self, time: float, period: float) -> None:
        """Read the robot, then add the noise.

        Args:
            time: Station time of this cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        self._read(time, period)
        draws = self._random.standard_normal(2 * len(self._handles)).tolist()
        for i, handle in enumerate(self._handles):
            handle.position_storage[handle.index] += self._position * draws[2 * i]
            handle.velocity_storage[handle.index] += self._velocity * draws[2 * i + 1]
