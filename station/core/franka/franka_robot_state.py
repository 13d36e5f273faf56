"""The state that an arm reports once per cycle, under libfranka's names.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotState; differs: the arrays
are parts of one block of doubles, and time is in seconds.
"""
# ruff: noqa: N815, RUF009 - the names are libfranka's; the defaults are descriptors.

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import overload

from station.core.franka.franka_errors import ERROR_NAMES
from station.memory.doubles import Block, Doubles, put


class RobotMode(Enum):
    """The mode of the arm; the values are libfranka's."""

    OTHER = 0
    IDLE = 1
    MOVE = 2
    GUIDING = 3
    REFLEX = 4
    USER_STOPPED = 5
    AUTOMATIC_ERROR_RECOVERY = 6


class _Array:
    """A field whose numbers are in the block of the state.

    Reading it returns a new list, assigning to it copies the numbers.
    """

    def __init__(self, default: Sequence[float]) -> None:
        self._default = tuple(default)
        self._name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        _SIZES[name] = len(self._default)

    @overload
    def __get__(self, state: None, owner: type) -> tuple[float, ...]: ...

    @overload
    def __get__(self, state: "RobotState", owner: type) -> list[float]: ...

    def __get__(
        self, state: "RobotState | None", owner: type
    ) -> list[float] | tuple[float, ...]:
        if state is None:
            return self._default  # the constructor sets this value
        return [*state.doubles(self._name)]

    def __set__(self, state: "RobotState", values: Iterable[float]) -> None:
        put(state.doubles(self._name), values)


# Sizes of the arrays by name, in the order of the fields.
_SIZES: dict[str, int] = {}


def _zeros(size: int) -> _Array:
    return _Array([0.0] * size)


def _pose() -> _Array:
    return _Array([
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ])  # fmt: skip


class _Mode:
    """The field `robot_mode`, kept as a number in the block as well."""

    @overload
    def __get__(self, state: None, owner: type) -> RobotMode: ...

    @overload
    def __get__(self, state: "RobotState", owner: type) -> RobotMode: ...

    def __get__(self, state: "RobotState | None", owner: type) -> RobotMode:
        if state is None:
            return RobotMode.OTHER
        mode: RobotMode = state.__dict__["_mode"]
        return mode

    def __set__(self, state: "RobotState", mode: RobotMode) -> None:
        state.__dict__["_mode"] = mode
        state.doubles(MODE)[0] = mode.value


SCALARS = ("time", "control_command_success_rate", "m_ee", "m_load", "m_total")
"""Fields that are single numbers, in the order of `RobotState.packed`."""
PackedState = tuple[bytes, tuple[float, ...], tuple[bool, ...]]
"""An arm's state, as `RobotState.packed` returns it."""
MODE = "robot_mode"
"""Name of the part of the block that has the number of the mode."""


def array_places() -> dict[str, slice]:
    """Return the position of each array's bytes in a packed state."""
    places, start = {}, 0
    for name, size in {**_SIZES, MODE: 1}.items():
        places[name] = slice(8 * start, 8 * (start + size))
        start += size
    return places


def _flags() -> list[bool]:
    return [False] * len(ERROR_NAMES)


@dataclass
class RobotState:
    """State of an arm with 7 joints.

    The arm owns the object and changes it in place in `RobotArm.read_once`. Other code
    only reads it, in the control thread; other threads use a `copy`.

    The arrays are parts of one block of doubles. Reading an array, `state.q`, returns a
    new list; assigning, `state.q = values`, copies n numbers into it. The control cycle
    and the handles use the memory itself, `state.doubles("q")`.

    Fields after `control_command_success_rate` are derived from those before and from
    settings. Poses, twists and elbows are only computed when
    `FrankaStateHandle.get_robot_state` asks for them, to save time; frames and loads
    change at once with their settings.

    Poses have 16 numbers and tensors 9, flat and column-major: T(r, c) = T[4 c + r].
    Twists are linear, then angular velocity; wrenches force, then torque. Frames: O the
    base, F the flange, NE the nominal end effector, EE the end effector, K the
    stiffness frame.

    Attributes:
        q: Measured positions [rad], shape (7,).
        dq: Measured velocities [rad/s], shape (7,).
        tau_J: Measured link-side torques, gravity included [Nm], shape (7,).
        dtau_J: Rates of these torques [Nm/s], shape (7,).
        q_d: Desired positions [rad], shape (7,).
        dq_d: Desired velocities [rad/s], shape (7,).
        ddq_d: Desired accelerations [rad/s^2], shape (7,).
        tau_J_d: Desired link-side torques without gravity; 0 when idle [Nm], (7,).
        theta: Motor-side positions [rad], shape (7,).
        dtheta: Motor-side velocities [rad/s], shape (7,).
        tau_ext_hat_filtered: Torques on the environment: `tau_J` minus the torques that
            the model explains, low-passed [Nm], shape (7,).
        O_F_ext_hat_K: Wrench of the robot on its environment at K, axes of O [N, Nm],
            shape (6,); 0 near singular poses.
        K_F_ext_hat_K: The same wrench in the axes of K.
        joint_contact: 1 where `tau_ext_hat_filtered` is above the lower threshold,
            else 0, shape (7,).
        joint_collision: As `joint_contact`, for the upper threshold; stays until
            recovery.
        cartesian_contact: As `joint_contact`, for `K_F_ext_hat_K`, shape (6,).
        cartesian_collision: As `joint_collision`, for `K_F_ext_hat_K`, shape (6,).
        current_errors: Flags in the order of `ERROR_NAMES`, shape (41,).
        last_motion_errors: Flags of the errors that ended the last motion, shape (41,).
        robot_mode: Mode of the arm.
        time: Time since the arm was started [s]; strictly increasing.
        control_command_success_rate: Share of the last 100 commands that arrived, 0 to
            1; 0 while no motion runs.
        O_T_EE: Measured pose of the end effector in O.
        O_T_EE_d: Desired pose.
        O_T_EE_c: Commanded pose, after filter and limits.
        F_T_EE: End effector in the flange frame, `F_T_NE` `NE_T_EE`.
        F_T_NE: Nominal end effector in the flange frame.
        NE_T_EE: End effector in the nominal end effector frame; `set_EE_frame`.
        EE_T_K: Stiffness frame in the end effector; `set_K_frame`.
        m_ee: Mass of the end effector [kg].
        F_x_Cee: Its centre of mass in F [m], shape (3,).
        I_ee: Its inertia about this centre, axes of F [kg m^2].
        m_load: Mass of the load [kg]; `set_load`.
        F_x_Cload: Its centre of mass in F [m], shape (3,).
        I_load: Its inertia about this centre, axes of F [kg m^2].
        m_total: Mass of end effector and load [kg].
        F_x_Ctotal: Centre of mass of end effector and load in F [m], shape (3,).
        I_total: Their inertia about this centre, axes of F [kg m^2].
        elbow: Position of joint 3 [rad] and sign of the flip of joint 4.
        elbow_d: Desired elbow.
        elbow_c: Commanded elbow.
        delbow_c: Rate of `elbow_c`; the second number is 0 [rad/s].
        ddelbow_c: Rate of `delbow_c`; the second number is 0 [rad/s^2].
        O_dP_EE_d: Desired twist of the end effector [m/s, rad/s], shape (6,).
        O_dP_EE_c: Commanded twist, shape (6,).
        O_ddP_EE_c: Rate of `O_dP_EE_c` [m/s^2, rad/s^2], shape (6,).
        O_ddP_O: Acceleration of gravity in O [m/s^2], shape (3,).
    """

    q: _Array = _zeros(7)
    dq: _Array = _zeros(7)
    tau_J: _Array = _zeros(7)
    dtau_J: _Array = _zeros(7)
    q_d: _Array = _zeros(7)
    dq_d: _Array = _zeros(7)
    ddq_d: _Array = _zeros(7)
    tau_J_d: _Array = _zeros(7)
    theta: _Array = _zeros(7)
    dtheta: _Array = _zeros(7)
    tau_ext_hat_filtered: _Array = _zeros(7)
    O_F_ext_hat_K: _Array = _zeros(6)
    K_F_ext_hat_K: _Array = _zeros(6)
    joint_contact: _Array = _zeros(7)
    joint_collision: _Array = _zeros(7)
    cartesian_contact: _Array = _zeros(6)
    cartesian_collision: _Array = _zeros(6)
    current_errors: list[bool] = field(default_factory=_flags)
    last_motion_errors: list[bool] = field(default_factory=_flags)
    robot_mode: _Mode = _Mode()
    time: float = 0.0
    control_command_success_rate: float = 0.0
    O_T_EE: _Array = _pose()
    O_T_EE_d: _Array = _pose()
    O_T_EE_c: _Array = _pose()
    F_T_EE: _Array = _pose()
    F_T_NE: _Array = _pose()
    NE_T_EE: _Array = _pose()
    EE_T_K: _Array = _pose()
    m_ee: float = 0.0
    F_x_Cee: _Array = _zeros(3)
    I_ee: _Array = _zeros(9)
    m_load: float = 0.0
    F_x_Cload: _Array = _zeros(3)
    I_load: _Array = _zeros(9)
    m_total: float = 0.0
    F_x_Ctotal: _Array = _zeros(3)
    I_total: _Array = _zeros(9)
    elbow: _Array = _zeros(2)
    elbow_d: _Array = _zeros(2)
    elbow_c: _Array = _zeros(2)
    delbow_c: _Array = _zeros(2)
    ddelbow_c: _Array = _zeros(2)
    O_dP_EE_d: _Array = _zeros(6)
    O_dP_EE_c: _Array = _zeros(6)
    O_ddP_EE_c: _Array = _zeros(6)
    O_ddP_O: _Array = _zeros(3)

    def __new__(cls, *_args: object, **_values: object) -> "RobotState":
        """Make the block before the fields are set."""
        state = super().__new__(cls)
        # Not a field, because libfranka's state does not have it.
        state.__dict__["block"] = Block({**_SIZES, MODE: 1})
        return state

    def doubles(self, name: str) -> Doubles:
        """Return the memory of an array, the same object at every call.

        Args:
            name: Name of the field, e.g. "q".
        """
        block: Block = self.__dict__["block"]
        return block[name]

    def arrays(self) -> Doubles:
        """Return the memory of all arrays side by side; see `array_places`."""
        block: Block = self.__dict__["block"]
        return block.memory

    def readings(self) -> Doubles:
        """Return the memory of `q`, `dq` and `tau_J`, one after the other, (21,)."""
        block: Block = self.__dict__["block"]
        return block.memory[: sum(_SIZES[name] for name in ("q", "dq", "tau_J"))]

    def motion(self) -> Doubles:
        """Return the memory of the arrays `q` to `tau_J_d`, side by side, (56,)."""
        block: Block = self.__dict__["block"]
        return block.memory[: 8 * _SIZES["q"]]

    def packed(self) -> PackedState:
        """Return a copy in three pieces, in a tenth of the time of `copy`.

        Returns:
            The block of doubles in the order of the arrays' fields; `SCALARS`; the
            flags of `current_errors`, then those of `last_motion_errors`.
        """
        block: Block = self.__dict__["block"]
        scalars = (
            self.time,
            self.control_command_success_rate,
            self.m_ee,
            self.m_load,
            self.m_total,
        )
        flags = (*self.current_errors, *self.last_motion_errors)
        return block.memory.tobytes(), scalars, flags

    @classmethod
    def unpacked(cls, packed: PackedState) -> "RobotState":
        """Return the state that `packed` has copied."""
        memory, scalars, flags = packed
        state = cls()
        block: Block = state.__dict__["block"]
        block.memory[:] = memoryview(memory).cast("d")
        state.robot_mode = RobotMode(int(block[MODE][0]))
        for name, value in zip(SCALARS, scalars, strict=True):
            setattr(state, name, value)
        count = len(flags) // 2
        state.current_errors = list(flags[:count])
        state.last_motion_errors = list(flags[count:])
        return state

    def copy(self) -> "RobotState":
        """Return a copy that no longer changes, for other threads."""
        result = replace(self)
        result.current_errors = list(self.current_errors)
        result.last_motion_errors = list(self.last_motion_errors)
        return result
