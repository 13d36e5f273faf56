"""Read and drive some joints of the simulated world, in plain floats."""

from array import array
from collections.abc import Callable, Sequence, Sized

import mujoco
import numpy as np
from numpy.typing import NDArray

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import JointStateHandle, JointStateInterface
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.memory.doubles import Doubles, as_doubles, doubles

_SINGLE_DOF = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))


class WorldJoints:
    """Joints of the world in a chosen order, n of them, each with its own motor.

    Reading returns new lists of n floats, never MuJoCo's own memory. Forces and inertia
    belong to the last step, positions and velocities to the end of that step. Only the
    thread that steps the world may use them.

    Args:
        model: The world's model.
        data: The world's data.
        names: Joints with one degree of freedom and a motor of the same name.
        pushes: The pushes that act at present, by body.
        brake_forces: Forces of `OverspeedBrakes` in the last step [Nm or N], shape
            (nv,); None in a world without brakes.

    Attributes:
        names: As given.
        timestep: Duration of a step [s].
        read_positions: Returns the positions [rad or m].
        read_velocities: Returns the velocities [rad/s or m/s].
        read_motor_forces: Returns the motors' forces in the last step [Nm or N].
        read_bias_forces: Returns Coriolis, centrifugal and gravity forces [Nm or N].
        read_compensation: Returns the gravity compensation's forces [Nm or N].
        read_inertia: Returns the diagonal of the joint-space inertia matrix, armature
            included [kg m^2 or kg].
        damping: Passive damping [Nm s/rad or N s/m].
        armature: Rotor inertia as seen at the joints [kg m^2 or kg].
        lower_limits: Lowest positions [rad or m]; infinite where unlimited.
        upper_limits: Highest positions [rad or m]; infinite where unlimited.
        effort_limits: Largest motor forces [Nm or N]; infinite where unlimited.
        memory: MuJoCo's own memory, by the names that `JointDrives` uses.
        places: Indices of the joints in this memory, shape (n,) each.

    Raises:
        HardwareInterfaceError: A joint is unknown, has several degrees of freedom, or
            has no motor.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        names: Sequence[str],
        *,
        pushes: Sized = (),
        brake_forces: NDArray[np.float64] | None = None,
    ) -> None:
        joints = [find_joint(model, name) for name in names]
        positions = [int(model.jnt_qposadr[joint]) for joint in joints]
        dofs = [int(model.jnt_dofadr[joint]) for joint in joints]
        motors = [_find_motor(model, name) for name in names]
        self.names = tuple(names)
        self.read_positions = _reader(data.qpos, positions)
        self.read_velocities = _reader(data.qvel, dofs)
        self.read_motor_forces = _reader(data.actuator_force, motors)
        if brake_forces is None:
            brake_forces = np.zeros(model.nv)
        self.read_bias_forces = _reader(data.qfrc_bias, dofs)
        self.read_compensation = _reader(data.qfrc_gravcomp, dofs)
        self.damping: list[float] = model.dof_damping[dofs].tolist()
        self.armature: list[float] = model.dof_armature[dofs].tolist()
        limited = model.jnt_limited[joints]
        lower, upper = model.jnt_range[joints].T
        self.lower_limits: list[float] = np.where(limited, lower, -np.inf).tolist()
        self.upper_limits: list[float] = np.where(limited, upper, np.inf).tolist()
        limited = model.actuator_forcelimited[motors]
        highest = model.actuator_forcerange[motors, 1]
        self.effort_limits: list[float] = np.where(limited, highest, np.inf).tolist()
        self.memory = _memory(model, data)
        self.places = _places(model, positions, dofs, motors)
        self.read_inertia = _reader(data.M, self.places["inertia"].tolist())
        self.timestep = float(model.opt.timestep)
        self._data = data
        self._pushes = pushes
        self._joints, self._dofs = joints, dofs
        self._positions = positions
        self._brake_forces = brake_forces
        self._dof_damping = model.dof_damping
        self._read_constraints = _reader(data.qfrc_constraint, dofs)
        self._read_smooth = _reader(data.qfrc_smooth, dofs)
        self._read_passive = _reader(data.qfrc_passive, dofs)
        self._read_actuators = _reader(data.qfrc_actuator, dofs)
        self._model = model
        self._motors = motors

    def simulator_memory(self) -> SimulatorMemory:
        """Return MuJoCo's memory of these joints.

        Raises:
            HardwareInterfaceError: The joints or motors do not lie side by side.
        """
        data, dofs, motors = self._data, self._dofs, self._motors
        positions = self._positions
        if not all(map(_as_slice, (positions, dofs, motors))):
            raise HardwareInterfaceError(
                f"The joints {', '.join(self.names)} do not follow one another in the "
                "simulated world.",
                remedy="Let nothing else move between them.",
                details={"joints": list(self.names)},
            )
        diagonal = self.places["inertia"].tolist()
        return SimulatorMemory(
            len(dofs),
            positions=_view(data.qpos, positions),
            velocities=_view(data.qvel, dofs),
            motor_forces=_view(data.actuator_force, motors),
            brake_forces=_view(self._brake_forces, dofs),
            bias=_view(data.qfrc_bias, dofs),
            compensation=_view(data.qfrc_gravcomp, dofs),
            constraint_forces=_view(data.qfrc_constraint, dofs),
            inertia=as_doubles(data.M),
            diagonal=memoryview(array("l", diagonal)),
            controls=_view(data.ctrl, motors),
            limits=doubles(self.effort_limits),
            passive_damping=doubles(self.damping),
            armature=doubles(self.armature),
            applied=_view(data.qfrc_applied, dofs),
        )

    def read_external_forces(self) -> list[float]:
        """Return the joint forces of contacts and pushes in the last step [Nm or N].

        Forces of mechanical stops are left out, because they act inside the robot.
        """
        forces = self._read_constraints()
        if self._data.nl and any(forces):
            self._remove_stops(forces)
        if self._pushes:
            for i, (smooth, bias, passive, actuator) in enumerate(
                zip(
                    self._read_smooth(),
                    self.read_bias_forces(),
                    self._read_passive(),
                    self._read_actuators(),
                    strict=True,
                )
            ):
                forces[i] += smooth + bias - passive - actuator
        return forces

    def set_extra_damping(self, joint: int, damping: float) -> None:
        """Add passive damping to one joint.

        Args:
            joint: Index of the joint in `names`.
            damping: Additional damping, >= 0 [Nm s/rad or N s/m].
        """
        self._dof_damping[self._dofs[joint]] = self.damping[joint] + damping

    def _remove_stops(self, forces: list[float]) -> None:
        data = self._data
        first = int(data.ne) + int(data.nf)
        for row in range(first, first + int(data.nl)):
            joint = int(data.efc_id[row])
            if joint in self._joints:
                slot = self._joints.index(joint)
                middle = (self.lower_limits[slot] + self.upper_limits[slot]) / 2.0
                force = float(data.efc_force[row])
                at_lower = self.read_positions()[slot] < middle
                forces[slot] -= force if at_lower else -force

    def set_servo(self, stiffness: list[float], damping: list[float]) -> None:
        """Let the motors give control - stiffness * position - damping * velocity.

        The integrator treats the damping implicitly, so that every damping is stable.

        Args:
            stiffness: Stiffness, >= 0 [Nm/rad or N/m], shape (n,).
            damping: Damping, >= 0 [Nm s/rad or N s/m], shape (n,). With both zero the
                motors are pure force sources.
        """
        for motor, k, d in zip(self._motors, stiffness, damping, strict=True):
            self._model.actuator_biasprm[motor, 1] = -k
            self._model.actuator_biasprm[motor, 2] = -d

    def set_effort_limits(self, limits: list[float]) -> None:
        """Limit the forces of the motors.

        Args:
            limits: Largest forces, > 0 [Nm or N], shape (n,).
        """
        for motor, limit in zip(self._motors, limits, strict=True):
            self._model.actuator_forcelimited[motor] = True
            self._model.actuator_forcerange[motor] = [-limit, limit]
        self.effort_limits = list(limits)


class UnpoweredJoints:
    """Offers the states of joints that have no motor, with an effort of 0.

    Args:
        model: The world's model.
        data: The world's data.
        names: Joints with one degree of freedom, with or without a motor.
        interface: Receives their handles.

    Raises:
        HardwareInterfaceError: A joint is unknown.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        names: Sequence[str],
        interface: JointStateInterface,
    ) -> None:
        joints = [find_joint(model, name) for name in names]
        self._read_positions = _reader(
            data.qpos, [int(model.jnt_qposadr[joint]) for joint in joints]
        )
        self._read_velocities = _reader(
            data.qvel, [int(model.jnt_dofadr[joint]) for joint in joints]
        )
        self._position, self._velocity = [0.0] * len(names), [0.0] * len(names)
        effort = [0.0] * len(names)
        for index, name in enumerate(names):
            interface.register_handle(
                JointStateHandle(name, self._position, self._velocity, effort, index)
            )

    def read(self) -> None:
        """Bring the states up to date. Control thread."""
        self._position[:] = self._read_positions()
        self._velocity[:] = self._read_velocities()


def joint_position_address(model: mujoco.MjModel, name: str) -> int:
    """Return the index of a joint's position in `qpos`.

    Raises:
        HardwareInterfaceError: The model has no such joint with one degree of freedom.
    """
    return int(model.jnt_qposadr[find_joint(model, name)])


def find_joint(model: mujoco.MjModel, name: str) -> int:
    """Return the number of a joint in the model.

    Raises:
        HardwareInterfaceError: The model has no such joint with one degree of freedom.
    """
    joint: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    if joint < 0 or int(model.jnt_type[joint]) not in _SINGLE_DOF:
        known = [model.joint(i).name for i in range(model.njnt)]
        raise HardwareInterfaceError(
            f"The simulated world has no hinge or slide joint {name!r}.",
            remedy=f"Choose among {', '.join(known) or 'none'}.",
            details={"joint": name},
        )
    return joint


def _find_motor(model: mujoco.MjModel, name: str) -> int:
    motor: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    if motor < 0:
        raise HardwareInterfaceError(
            f"Joint {name!r} has no motor in the simulated world.",
            remedy="Mimic joints and joints with an effort limit of 0 have none.",
            details={"joint": name},
        )
    return motor


def _view(values: NDArray[np.float64], indices: list[int]) -> Doubles:
    return as_doubles(values)[indices[0] : indices[0] + len(indices)]


def _memory(model: mujoco.MjModel, data: mujoco.MjData) -> "dict[str, Doubles]":
    return {
        "qpos": memoryview(data.qpos),
        "qvel": memoryview(data.qvel),
        "bias": memoryview(data.qfrc_bias),
        "weight": memoryview(data.qfrc_gravcomp),
        "inertia": memoryview(data.M),
        "control": memoryview(data.ctrl),
        "damping": memoryview(model.actuator_biasprm.reshape(-1)),
    }


def _places(
    model: mujoco.MjModel, positions: list[int], dofs: list[int], motors: list[int]
) -> "dict[str, memoryview[int]]":
    # Each row of the inertia matrix ends with its diagonal element.
    diagonal = model.M_rowadr + model.M_rownnz - 1
    # The motors' velocity coefficients are a column of their table.
    columns = model.actuator_biasprm.shape[1]
    places = {
        "qpos": positions,
        "dof": dofs,
        "inertia": diagonal[dofs].tolist(),
        "control": motors,
        "damping": [columns * motor + 2 for motor in motors],
    }
    return {name: memoryview(array("q", values)) for name, values in places.items()}


def _as_slice(indices: list[int]) -> slice | None:
    """Return the slice that selects `indices`, or None if they are not consecutive."""
    if indices and indices == list(range(indices[0], indices[0] + len(indices))):
        return slice(indices[0], indices[0] + len(indices))
    return None


def _reader(
    array: NDArray[np.float64], indices: list[int]
) -> Callable[[], list[float]]:
    row = _as_slice(indices)
    if row is not None:
        return array[row].tolist  # a view: 0.1 us instead of 1 us a read
    selector = np.array(indices, dtype=np.intp)
    return lambda: array.take(selector).tolist()
