"""Mass matrix, Coriolis and gravity torques of the arm with a load at its flange.

The links are those of the URDF, without rotor inertia, friction, hand and fingers: what
is mounted at the flange is the load, as libfranka has it. MuJoCo does the arithmetic on
a model of its own, apart from any simulated world.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Urdf
from station.hw.franka.arm.arm_names import find_prefix
from station.hw.franka.arm.load import Load
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.stepper import direct_function
from station.hw.urdf_loader import load_urdf

_DOF = 7
_EARTH = (0.0, 0.0, -9.81)
_NO_LOAD = Load()
_LOAD_BODY = "load_at_flange"
# Flange in the frame of link 7 [m]; see `franka_kinematics`.
_FLANGE_OFFSET = (0.0, 0.0, 0.107)
_DISABLED = (
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    | mujoco.mjtDisableBit.mjDSBL_CONTACT
    | mujoco.mjtDisableBit.mjDSBL_SENSOR
)


class FrankaDynamics:
    """Dynamics of one arm. Not thread safe: one instance per thread.

    Source of the conventions: libfranka@0.9.2 include/franka/model.h, Model.

    Args:
        description: The URDF of a Franka arm.

    Raises:
        RobotDescriptionError: It is no Franka arm or cannot be simulated.
    """

    def __init__(self, description: RobotFiles) -> None:
        prefix = find_prefix(description)
        spec = new_world(0.001, floor=False)
        urdf = _arm_alone(load_urdf(description), prefix)
        add_robot(spec, urdf, RobotOptions(armature=0.0, gravity_compensation=False))
        spec.option.disableflags |= int(_DISABLED)
        load = spec.body(f"{prefix}link7").add_body(name=_LOAD_BODY, pos=_FLANGE_OFFSET)
        load.explicitinertial = True
        self._model = compile_world(spec)
        self._data = mujoco.MjData(self._model)
        self._load_body = int(self._model.body(_LOAD_BODY).id)
        # The compiled shortcut of an inertial frame like the body's does not hold.
        none = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
        self._model.body_sameframe[self._load_body] = int(none)
        self._load = _NO_LOAD
        self._read_mass: Callable[[], list[float]] = self._data.M.tolist
        self._read_bias: Callable[[], list[float]] = self._data.qfrc_bias.tolist
        self._compute: list[Callable[[], None]] = [
            direct_function(name, self._model, self._data)
            for name in ("mj_fwdPosition", "mj_fwdVelocity")
        ]

    def mass(self, q: Sequence[float], load: Load = _NO_LOAD) -> list[float]:
        """Return the mass matrix [kg m^2], 7 x 7, flat.

        Args:
            q: Joint positions [rad], shape (7,).
            load: What is fixed to the flange.
        """
        self._evaluate(q, [0.0] * _DOF, load, (0.0, 0.0, 0.0))
        # The rows of a chain's lower triangle, one after the other.
        packed = self._read_mass()
        result = [0.0] * (_DOF * _DOF)
        for row in range(_DOF):
            start = row * (row + 1) // 2
            for column in range(row + 1):
                value = packed[start + column]
                result[row * _DOF + column] = result[column * _DOF + row] = value
        return result

    def coriolis(
        self, q: Sequence[float], dq: Sequence[float], load: Load = _NO_LOAD
    ) -> list[float]:
        """Return the Coriolis and centrifugal torques C(q, dq) dq [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            load: What is fixed to the flange.
        """
        return self._evaluate(q, dq, load, (0.0, 0.0, 0.0))

    def gravity(
        self,
        q: Sequence[float],
        load: Load = _NO_LOAD,
        gravity_earth: Sequence[float] = _EARTH,
    ) -> list[float]:
        """Return the torques that hold the arm against gravity [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            load: What is fixed to the flange.
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """
        return self._evaluate(q, [0.0] * _DOF, load, gravity_earth)

    def torques(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        ddq: Sequence[float],
        load: Load = _NO_LOAD,
        gravity_earth: Sequence[float] = _EARTH,
    ) -> list[float]:
        """Return the torques of a motion, M ddq + C dq + g [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            ddq: Joint accelerations [rad/s^2], shape (7,).
            load: What is fixed to the flange.
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """
        mass = self.mass(q, load)
        bias = self._evaluate(q, dq, load, gravity_earth)
        return [
            sum(m * a for m, a in zip(mass[row : row + _DOF], ddq, strict=True)) + b
            for row, b in zip(range(0, _DOF * _DOF, _DOF), bias, strict=True)
        ]

    def _evaluate(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        load: Load,
        gravity: Sequence[float],
    ) -> list[float]:
        if load != self._load:
            self._set_load(load)
        self._model.opt.gravity[:] = gravity
        self._data.qpos[:] = q
        self._data.qvel[:] = dq
        for compute in self._compute:
            compute()
        return self._read_bias()

    def _set_load(self, load: Load) -> None:
        body, model = self._load_body, self._model
        moments, axes = np.linalg.eigh(np.reshape(load.inertia, (3, 3)))
        if np.linalg.det(axes) < 0.0:
            axes[:, 0] = -axes[:, 0]
        mujoco.mju_mat2Quat(model.body_iquat[body], axes.ravel())
        model.body_mass[body] = load.mass
        model.body_inertia[body] = moments
        model.body_ipos[body] = load.center_of_mass
        self._load = load


def _arm_alone(urdf: Urdf, prefix: str) -> Urdf:
    """Return the links 0 to 7 of a URDF, without shapes, and the joints between."""
    links = {f"{prefix}link{number}" for number in range(_DOF + 1)}
    joints = {f"{prefix}joint{number}" for number in range(1, _DOF + 1)}
    return Urdf(
        urdf.name,
        {
            n: replace(link, collisions=())
            for n, link in urdf.links.items()
            if n in links
        },
        {n: joint for n, joint in urdf.joints.items() if n in joints},
        urdf.root,
    )
