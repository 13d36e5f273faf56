"""The state that an arm reports once per cycle, under libfranka's names.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotState; differs: plain lists
of floats that stay the same objects for the life of the arm, and time in seconds.
"""
# ruff: noqa: N815 - the names are libfranka's.

from dataclasses import dataclass, field, fields, replace
from enum import Enum

from station.core.franka.franka_errors import ERROR_NAMES


class RobotMode(Enum):
    """What the arm is doing; the values are libfranka's."""

    OTHER = 0
    IDLE = 1
    MOVE = 2
    GUIDING = 3
    REFLEX = 4
    USER_STOPPED = 5
    AUTOMATIC_ERROR_RECOVERY = 6


def _joints() -> list[float]:
    return [0.0] * 7


def _twist() -> list[float]:
    return [0.0] * 6


def _vector() -> list[float]:
    return [0.0] * 3


def _tensor() -> list[float]:
    return [0.0] * 9


def _pair() -> list[float]:
    return [0.0, 0.0]


def _pose() -> list[float]:
    return [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]  # fmt: skip


def _flags() -> list[bool]:
    return [False] * len(ERROR_NAMES)


@dataclass(slots=True)
class RobotState:
    """State of an arm with 7 joints.

    The arm owns the object and every list in it: it changes them in place in
    `RobotArm.read_once` and never replaces them, so a joint handle may keep a list. All
    others only read, in the control thread; whoever needs values elsewhere copies them.

    Fields after `control_command_success_rate` are derived from those before and from
    settings: they are brought up to date when `FrankaStateHandle.get_robot_state` asks
    for them, so that they take no time unless they are used.

    Poses have 16 numbers and tensors 9, flat and column-major: T(r, c) = T[4 c + r].
    Twists are linear, then angular velocity; wrenches force, then torque. Frames: O the
    base, F the flange, NE the nominal end effector, EE the end effector, K the
    stiffness frame.

    Attributes:
        q: Measured positions [rad], shape (7,).
        dq: Measured velocities [rad/s], shape (7,).
        tau_J: Measured link-side torques, gravity included [Nm], shape (7,).
        dtau_J: Their rate [Nm/s], shape (7,).
        q_d: Desired positions [rad], shape (7,).
        dq_d: Desired velocities [rad/s], shape (7,).
        ddq_d: Desired accelerations [rad/s^2], shape (7,).
        tau_J_d: Desired link-side torques without gravity; 0 when idle [Nm], (7,).
        theta: Motor-side positions [rad], shape (7,).
        dtheta: Motor-side velocities [rad/s], shape (7,).
        tau_ext_hat_filtered: Torques on the environment: `tau_J` less what the model
            needs, low-passed [Nm], shape (7,).
        O_F_ext_hat_K: Wrench of the robot on its environment at K, axes of O [N, Nm],
            shape (6,); 0 near singular poses.
        K_F_ext_hat_K: The same in the axes of K.
        joint_contact: 1 where `tau_ext_hat_filtered` is above the lower threshold,
            else 0, shape (7,).
        joint_collision: The same for the upper threshold; stays until recovery.
        cartesian_contact: As `joint_contact`, for `K_F_ext_hat_K`, shape (6,).
        cartesian_collision: As `joint_collision`, for `K_F_ext_hat_K`, shape (6,).
        current_errors: Flags in the order of `ERROR_NAMES`, shape (41,).
        last_motion_errors: Those that ended the last motion; empty flags if none did.
        robot_mode: What the arm is doing.
        time: Since the arm was started [s]; strictly increasing.
        control_command_success_rate: Share of the last 100 commands that arrived, 0 to
            1; 0 while no motion runs.
        O_T_EE: Measured pose of the end effector in O.
        O_T_EE_d: Desired pose.
        O_T_EE_c: Commanded pose, after filter and limits.
        F_T_EE: End effector in the flange frame, `F_T_NE` `NE_T_EE`.
        F_T_NE: Nominal end effector in the flange frame.
        NE_T_EE: End effector in the nominal one; `set_EE_frame`.
        EE_T_K: Stiffness frame in the end effector; `set_K_frame`.
        m_ee: Mass of the end effector [kg].
        F_x_Cee: Its centre of mass in F [m], shape (3,).
        I_ee: Its inertia about that, axes of F [kg m^2].
        m_load: Mass of the load [kg]; `set_load`.
        F_x_Cload: Its centre of mass in F [m], shape (3,).
        I_load: Its inertia about that, axes of F [kg m^2].
        m_total: Mass of both [kg].
        F_x_Ctotal: Their common centre of mass in F [m], shape (3,).
        I_total: Their inertia about that, axes of F [kg m^2].
        elbow: Position of joint 3 [rad] and sign of the flip of joint 4.
        elbow_d: Desired elbow.
        elbow_c: Commanded elbow.
        delbow_c: Rate of `elbow_c`; the second number is 0 [rad/s].
        ddelbow_c: Its rate; the second number is 0 [rad/s^2].
        O_dP_EE_d: Desired twist of the end effector [m/s, rad/s], shape (6,).
        O_dP_EE_c: Commanded twist, shape (6,).
        O_ddP_EE_c: Its rate [m/s^2, rad/s^2], shape (6,).
        O_ddP_O: Acceleration of gravity in O [m/s^2], shape (3,).
    """

    q: list[float] = field(default_factory=_joints)
    dq: list[float] = field(default_factory=_joints)
    tau_J: list[float] = field(default_factory=_joints)
    dtau_J: list[float] = field(default_factory=_joints)
    q_d: list[float] = field(default_factory=_joints)
    dq_d: list[float] = field(default_factory=_joints)
    ddq_d: list[float] = field(default_factory=_joints)
    tau_J_d: list[float] = field(default_factory=_joints)
    theta: list[float] = field(default_factory=_joints)
    dtheta: list[float] = field(default_factory=_joints)
    tau_ext_hat_filtered: list[float] = field(default_factory=_joints)
    O_F_ext_hat_K: list[float] = field(default_factory=_twist)
    K_F_ext_hat_K: list[float] = field(default_factory=_twist)
    joint_contact: list[float] = field(default_factory=_joints)
    joint_collision: list[float] = field(default_factory=_joints)
    cartesian_contact: list[float] = field(default_factory=_twist)
    cartesian_collision: list[float] = field(default_factory=_twist)
    current_errors: list[bool] = field(default_factory=_flags)
    last_motion_errors: list[bool] = field(default_factory=_flags)
    robot_mode: RobotMode = RobotMode.OTHER
    time: float = 0.0
    control_command_success_rate: float = 0.0
    O_T_EE: list[float] = field(default_factory=_pose)
    O_T_EE_d: list[float] = field(default_factory=_pose)
    O_T_EE_c: list[float] = field(default_factory=_pose)
    F_T_EE: list[float] = field(default_factory=_pose)
    F_T_NE: list[float] = field(default_factory=_pose)
    NE_T_EE: list[float] = field(default_factory=_pose)
    EE_T_K: list[float] = field(default_factory=_pose)
    m_ee: float = 0.0
    F_x_Cee: list[float] = field(default_factory=_vector)
    I_ee: list[float] = field(default_factory=_tensor)
    m_load: float = 0.0
    F_x_Cload: list[float] = field(default_factory=_vector)
    I_load: list[float] = field(default_factory=_tensor)
    m_total: float = 0.0
    F_x_Ctotal: list[float] = field(default_factory=_vector)
    I_total: list[float] = field(default_factory=_tensor)
    elbow: list[float] = field(default_factory=_pair)
    elbow_d: list[float] = field(default_factory=_pair)
    elbow_c: list[float] = field(default_factory=_pair)
    delbow_c: list[float] = field(default_factory=_pair)
    ddelbow_c: list[float] = field(default_factory=_pair)
    O_dP_EE_d: list[float] = field(default_factory=_twist)
    O_dP_EE_c: list[float] = field(default_factory=_twist)
    O_ddP_EE_c: list[float] = field(default_factory=_twist)
    O_ddP_O: list[float] = field(default_factory=_vector)

    def copy(self) -> "RobotState":
        """Return a copy that no longer changes, for other threads."""
        result = replace(self)
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, list):
                setattr(result, one.name, list(value))
        return result
