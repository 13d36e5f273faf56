"""Wire models of robots: hardware, arms, their services and grippers.

Hardware is interfaces, claims, limits, transmissions and clamps.
"""
# ruff: noqa: N815 - the names are libfranka's.

from typing import Annotated, Literal

from pydantic import AliasChoices, BeforeValidator, Field

from station.reports import (
    ArmRecord,
    HardwareComponentReport,
    HardwareInterface,
    HardwareTransmission,
)
from station.wire.base import (
    FromEnum,
    Items,
    Measured,
    Measurements,
    Reason,
    RequestModel,
    ResponseModel,
)

Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Wrench = Annotated[list[float], Field(min_length=6, max_length=6)]
Joints = Annotated[list[float], Field(min_length=7, max_length=7)]
Tensor = Annotated[list[float], Field(min_length=9, max_length=9)]
Transform = Annotated[list[float], Field(min_length=16, max_length=16)]
RobotModeName = Annotated[
    Literal[
        "other",
        "idle",
        "move",
        "guiding",
        "reflex",
        "user_stopped",
        "automatic_error_recovery",
    ],
    FromEnum,
]
FrameName = Literal[
    "joint1",
    "joint2",
    "joint3",
    "joint4",
    "joint5",
    "joint6",
    "joint7",
    "flange",
    "end_effector",
    "stiffness",
]
ClampReasonName = Annotated[
    Literal["position", "velocity", "acceleration", "jerk", "effort", "soft_position"],
    FromEnum,
]


RepairKindName = Literal[
    "inertia",
    "mass",
    "range",
    "mimic",
    "motor",
    "friction",
    "transmission",
    "self_collision",
    "start_pose",
    "base",
    "name",
    "armature",
    "gravity",
    "ros2_control",
]


ComponentStateName = Literal["unconfigured", "inactive", "active", "finalized"]
"""A state of a hardware component, in ros2_control's words."""


class ArmError(ResponseModel):
    """One error of an arm.

    Attributes:
        name: libfranka's name.
        where: Joint, axis or quantity; empty if none is concerned.
        value: Measured value.
        limit: Allowed value.
        unit: Unit of both.
        cycle: Number of the arm's cycle.
        description: One sentence.
    """

    name: str
    where: Reason
    value: Measured
    limit: Measured
    unit: str
    cycle: int
    description: Reason


class ArmReport(ResponseModel):
    """An arm at a glance.

    Attributes:
        arm_id: Its name.
        robot_mode: Mode of the arm.
        connected: Whether the station is connected to the arm.
        errors: Present errors, or else the errors that ended the last motion.
        remedy: Step needed before the arm can move; empty when it can.
        caution: Warning that estimates of external forces come near the threshold of a
            collision, and advice; empty when they do not.
    """

    arm_id: str
    robot_mode: RobotModeName
    connected: bool = Field(validation_alias=AliasChoices("connected", "is_connected"))
    errors: Items[ArmError]
    remedy: Reason
    caution: Reason = ""


class ServiceInfo(ResponseModel):
    """A service of a robot.

    Attributes:
        name: Its name.
        method: HTTP method of its route.
        path: Last part of its route: `/robots/{arm_id}/{path}`.
        description: Effect.
        parameters: Names of its parameters, the keys of the request's body.
    """

    name: str
    method: str
    path: str
    description: str
    parameters: list[str]


class Services(ResponseModel):
    """The services of a robot.

    Attributes:
        services: The services, in the order in which they are declared.
    """

    services: list[ServiceInfo]


class Arms(ResponseModel):
    """All arms of the station.

    Attributes:
        robots: The arms with their modes and errors.
    """

    robots: Items[ArmReport]


def _restart(value: object) -> object:
    """Return `value` if it can say what to start.

    Without this check there would be one error for each member of the union.

    Raises:
        ValueError: It cannot.
    """
    if isinstance(value, list | tuple) or value in ("none", "previous"):
        return value
    raise ValueError("must be 'none', 'previous' or a list of names of controllers")


class RecoveryRequest(RequestModel):
    """Way to recover from an error.

    Attributes:
        restart: `previous` starts the controllers again that the error stopped, and a
            list those that it names; with `none` nothing moves by itself.

    Example:
        {"restart": "previous"}
    """

    restart: Annotated[
        Literal["none", "previous"] | Annotated[list[str], Field(max_length=64)],
        BeforeValidator(_restart),
    ] = "none"


class Recovery(ArmReport):
    """An arm after its recovery.

    Attributes:
        restarted: Controllers that were started again.
    """

    restarted: Items[str]


class Recoveries(Arms):
    """All arms after the recovery of all.

    Attributes:
        restarted: Controllers that were started again.
    """

    restarted: Items[str]


class UserStopRequest(RequestModel):
    """Press or release the user stop.

    Attributes:
        pressed: True presses it, false releases it.

    Example:
        {"pressed": true}
    """

    pressed: bool


class GuidingRequest(RequestModel):
    """Press or release the guiding buttons.

    Attributes:
        pressed: True presses them, false releases them.

    Example:
        {"pressed": true}
    """

    pressed: bool


class ArmLog(ResponseModel):
    """The last cycles of the motion before the last error.

    Attributes:
        records: The cycles, oldest first, up to 50.
    """

    records: Items[ArmRecord]


class JointImpedance(RequestModel):
    """Stiffness of the internal joint impedance.

    Attributes:
        joint_stiffness: Stiffness of each joint [Nm/rad], 0 to 14250, shape (7,).

    Example:
        {"joint_stiffness": [3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0]}
    """

    joint_stiffness: Joints


class CartesianImpedance(RequestModel):
    """Stiffness of the internal Cartesian impedance.

    Attributes:
        cartesian_stiffness: Along and about the axes of the stiffness frame: three
            times 10 to 3000 [N/m], then three times 1 to 300 [Nm/rad].

    Example:
        {"cartesian_stiffness": [2000.0, 2000.0, 2000.0, 100.0, 100.0, 100.0]}
    """

    cartesian_stiffness: Wrench


class EndEffectorFrame(RequestModel):
    """Frame of the end effector.

    Attributes:
        NE_T_EE: Pose of the end effector in the nominal end effector frame, column-
            major, translation [m], shape (16,).

    Example:
        {"NE_T_EE": [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
         0.0, 0.1, 1.0]}
    """

    NE_T_EE: Transform


class StiffnessFrame(RequestModel):
    """Stiffness frame.

    Attributes:
        EE_T_K: Pose of the stiffness frame in the end effector frame, column-major,
            translation [m], shape (16,).

    Example:
        {"EE_T_K": [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
         0.0, 0.0, 1.0]}
    """

    EE_T_K: Transform


class Load(RequestModel):
    """The load that the hand holds.

    Attributes:
        mass: Mass [kg], 0 to the largest load of the arm.
        F_x_center_load: Centre of mass in the flange frame [m].
        load_inertia: Inertia about the centre of mass [kg m^2], column-major, shape
            (9,).

    Example:
        {"mass": 0.5, "F_x_center_load": [0.0, 0.0, 0.1], "load_inertia": [0.001, 0.0,
         0.0, 0.0, 0.001, 0.0, 0.0, 0.0, 0.001]}
    """

    mass: float
    F_x_center_load: Vector3
    load_inertia: Tensor


class ForceTorqueCollisionBehavior(RequestModel):
    """Thresholds of contact (lower) and collision (upper), in every phase.

    Attributes:
        lower_torque_thresholds_nominal: Torques of a contact [Nm], >= 0, shape (7,).
        upper_torque_thresholds_nominal: Torques of a collision [Nm], not below those of
            a contact, shape (7,).
        lower_force_thresholds_nominal: Forces [N], then torques [Nm] of a contact,
            >= 0, shape (6,).
        upper_force_thresholds_nominal: Forces [N], then torques [Nm] of a collision,
            not below those of a contact, shape (6,).

    Example:
        {"lower_torque_thresholds_nominal": [20.0, 20.0, 20.0, 20.0, 20.0, 20.0, 20.0],
         "upper_torque_thresholds_nominal": [40.0, 40.0, 40.0, 40.0, 40.0, 40.0, 40.0],
         "lower_force_thresholds_nominal": [10.0, 10.0, 10.0, 10.0, 10.0, 10.0],
         "upper_force_thresholds_nominal": [30.0, 30.0, 30.0, 30.0, 30.0, 30.0]}
    """

    lower_torque_thresholds_nominal: Joints
    upper_torque_thresholds_nominal: Joints
    lower_force_thresholds_nominal: Wrench
    upper_force_thresholds_nominal: Wrench


class FullCollisionBehavior(ForceTorqueCollisionBehavior):
    """Thresholds of `set_collision_behavior`, with separate ones while accelerating.

    Attributes:
        lower_torque_thresholds_acceleration: Torques of a contact [Nm], >= 0,
            shape (7,).
        upper_torque_thresholds_acceleration: Torques of a collision [Nm], not below
            those of a contact, shape (7,).
        lower_force_thresholds_acceleration: Forces [N], then torques [Nm] of a contact,
            >= 0, shape (6,).
        upper_force_thresholds_acceleration: Forces [N], then torques [Nm] of a
            collision, not below those of a contact, shape (6,).

    Example:
        {"lower_torque_thresholds_nominal": [20.0, 20.0, 20.0, 20.0, 20.0, 20.0, 20.0],
         "upper_torque_thresholds_nominal": [40.0, 40.0, 40.0, 40.0, 40.0, 40.0, 40.0],
         "lower_force_thresholds_nominal": [10.0, 10.0, 10.0, 10.0, 10.0, 10.0],
         "upper_force_thresholds_nominal": [30.0, 30.0, 30.0, 30.0, 30.0, 30.0],
         "lower_torque_thresholds_acceleration": [20.0, 20.0, 20.0, 20.0, 20.0, 20.0,
         20.0], "upper_torque_thresholds_acceleration": [40.0, 40.0, 40.0, 40.0, 40.0,
         40.0, 40.0], "lower_force_thresholds_acceleration": [10.0, 10.0, 10.0, 10.0,
         10.0, 10.0], "upper_force_thresholds_acceleration": [30.0, 30.0, 30.0, 30.0,
         30.0, 30.0]}
    """

    lower_torque_thresholds_acceleration: Joints
    upper_torque_thresholds_acceleration: Joints
    lower_force_thresholds_acceleration: Wrench
    upper_force_thresholds_acceleration: Wrench


class ExternalForce(RequestModel):
    """A push of a link, in simulation only.

    Attributes:
        link: Name of the link or object.
        force: Force [N], shape (3,).
        torque: Torque [Nm], shape (3,).
        duration: How long [s].
        frame: Axes of force and torque: `world`, or a link with which they turn.
        point: Point of application, in the link's frame [m]; the centre of mass if
            there is none.

    Example:
        {"link": "panda_hand", "force": [0.0, 0.0, -20.0], "duration": 0.5}
    """

    link: str = Field(min_length=1, max_length=128)
    force: Vector3 = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    torque: Vector3 = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    duration: float = Field(default=0.1, gt=0.0, le=3600.0)
    frame: str = Field(default="world", min_length=1, max_length=128)
    point: Vector3 | None = None


FaultName = Annotated[
    Literal["lost_packets", "delayed_cycle", "nan_sensor", "stuck_joint", "collision"],
    FromEnum,
]


class Fault(RequestModel):
    """A fault to inject, in simulation only.

    Attributes:
        kind: Kind of the fault.
        cycles: How many cycles of the arm the fault lasts. For a delayed cycle, by how
            many nominal periods the loop's next cycle is late, at most 500.
        joint: Number of the joint, 1 to 7, where the kind needs one.
        force: Force of a collision, axes of the world [N].

    Example:
        {"kind": "stuck_joint", "joint": 4, "cycles": 1000}
    """

    kind: FaultName
    cycles: int = Field(default=20, ge=1, le=1_000_000)
    joint: int = Field(default=1, ge=1, le=7)
    force: Vector3 = Field(default_factory=lambda: [0.0, 0.0, -100.0])


class ActiveFault(ResponseModel):
    """A fault that is active.

    Attributes:
        kind: Kind of the fault; a push of a link or an object is a collision.
        cycles: How many more cycles of the arm the fault lasts.
        joint: Number of the joint, where the kind has one.
    """

    kind: FaultName
    cycles: int
    joint: int


class Faults(ResponseModel):
    """The faults that are active.

    Attributes:
        faults: The faults, in the order in which they were injected.
    """

    faults: Items[ActiveFault]


class ArmModel(ResponseModel):
    """The model, evaluated in the present state; matrices column-major.

    Attributes:
        frame: Frame of pose and Jacobians.
        mass: Mass matrix [kg m^2], 7 x 7.
        coriolis: Coriolis torques [Nm], shape (7,).
        gravity: Torques that hold the arm against `O_ddP_O` [Nm].
        pose: Pose of the frame in the base frame, 4 x 4.
        zero_jacobian: Jacobian in the axes of the base, 6 x 7.
        body_jacobian: Jacobian in the axes of the frame, 6 x 7.
    """

    frame: Annotated[FrameName, FromEnum]
    mass: Measurements
    coriolis: Measurements
    gravity: Measurements
    pose: Measurements
    zero_jacobian: Measurements
    body_jacobian: Measurements


class RegionBudget(ResponseModel):
    """The budget of a body region.

    Attributes:
        speed: Speed up to which a transient contact stays below `force` [m/s].
        force: Force that the region bears in a transient contact [N].
        energy: Energy that the region absorbs in such a contact [J].
    """

    speed: float
    force: float
    energy: float


class ContactBudget(ResponseModel):
    """Estimate of the speeds at which a contact stays below a person's limits.

    It is no safety function.

    Attributes:
        direction: Direction of motion of the end effector, a unit vector in the base
            frame; at rest that of the largest effective mass.
        effective_mass: Mass that a push along it meets [kg].
        speed: Present speed of the end effector [m/s].
        regions: Budget by body region.
    """

    direction: Items[float]
    effective_mass: float
    speed: float
    regions: dict[str, RegionBudget]


class FrankaState(ResponseModel):
    """The whole state, as `franka_msgs/FrankaState`; see libfranka for each field.

    Units are SI, `time` in seconds; matrices column-major: T(r, c) = T[4 c + r]. A pose
    is a matrix of 16 numbers, with its translation [m] in the last column. Twists are
    linear, then angular velocity; wrenches force, then torque. Frames: O the base, F
    the flange, NE the nominal end effector, EE the end effector, K the stiffness frame.

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
        current_errors: Names of the present errors.
        last_motion_errors: Names of the errors that ended the last motion.
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
        least_clearance: Distance of the link and the object with the least gap, i.e.
            distance less margin [m]; null if the arm keeps clear of no object.
        nearest_pair: Names of this link and this object; empty without them.
    """

    robot_mode: RobotModeName
    time: float
    control_command_success_rate: float
    current_errors: Items[str]
    last_motion_errors: Items[str]
    q: Measurements
    dq: Measurements
    tau_J: Measurements
    dtau_J: Measurements
    q_d: Measurements
    dq_d: Measurements
    ddq_d: Measurements
    tau_J_d: Measurements
    theta: Measurements
    dtheta: Measurements
    tau_ext_hat_filtered: Measurements
    O_F_ext_hat_K: Measurements
    K_F_ext_hat_K: Measurements
    joint_contact: Measurements
    joint_collision: Measurements
    cartesian_contact: Measurements
    cartesian_collision: Measurements
    O_T_EE: Measurements
    O_T_EE_d: Measurements
    O_T_EE_c: Measurements
    F_T_EE: Measurements
    F_T_NE: Measurements
    NE_T_EE: Measurements
    EE_T_K: Measurements
    m_ee: float
    F_x_Cee: Measurements
    I_ee: Measurements
    m_load: float
    F_x_Cload: Measurements
    I_load: Measurements
    m_total: float
    F_x_Ctotal: Measurements
    I_total: Measurements
    elbow: Measurements
    elbow_d: Measurements
    elbow_c: Measurements
    delbow_c: Measurements
    ddelbow_c: Measurements
    O_dP_EE_d: Measurements
    O_dP_EE_c: Measurements
    O_ddP_EE_c: Measurements
    O_ddP_O: Measurements
    least_clearance: float | None = None
    nearest_pair: Items[str] = Field(default_factory=list)


GripperActionName = Annotated[Literal["homing", "move", "grasp"], FromEnum]
GripperActivityName = Annotated[
    Literal["idle", "homing", "moving", "grasping", "holding", "controlled"], FromEnum
]
GripperCommandStatus = Annotated[
    Literal["active", "succeeded", "aborted", "preempted"], FromEnum
]

_Identifier = Annotated[str, Field(strict=False, coerce_numbers_to_str=True)]
_Distance = Annotated[float, Field(ge=0.0)]
_Positive = Annotated[float, Field(gt=0.0)]


class GripperCommand(ResponseModel):
    """One homing, move or grasp, and its progress.

    Attributes:
        id: Its number in this run of the station.
        action: Commanded action.
        status: `active`, and finally `succeeded`, `aborted` (it did not reach its aim)
            or `preempted` (another command or a stop ended it).
        message: Why it did not succeed; empty when it did.
        request: The numbers that were asked for, by name [m, m/s, N].
        started: When it began [s, `time` of the gripper].
        ended: When it ended; null until then.
    """

    id: _Identifier = Field(validation_alias=AliasChoices("id", "identifier"))
    action: GripperActionName
    status: GripperCommandStatus
    message: Reason
    request: dict[str, float]
    started: float
    ended: float | None


class Gripper(ResponseModel):
    """A gripper's state, as `franka_gripper` has it, and its activity.

    Attributes:
        arm_id: The arm it belongs to.
        width: Distance between the fingers [m].
        max_width: Largest distance between the fingers, as the last homing measured it
            [m].
        is_grasped: Something of the expected width is held.
        temperature: Temperature of the gripper [degree Celsius].
        time: Time of the gripper [s]; never goes back.
        activity: Activity of the fingers. `holding`: they press with the force of
            the last grasp. `controlled`: a controller claims their joints.
        force: Force of each finger, > 0 outwards [N].
        command: The command that is active; null when there is none.
        last: The last command that ended; null when there is none.
    """

    arm_id: str
    width: Measured
    max_width: float
    is_grasped: bool
    temperature: float
    time: float
    activity: GripperActivityName
    force: Measured
    command: GripperCommand | None
    last: GripperCommand | None


class GripperMoveRequest(RequestModel):
    """Open or close to a width.

    Attributes:
        width: Distance between the fingers [m], 0 to `max_width`.
        speed: How fast the width changes, at most 0.4 [m/s].

    Example:
        {"width": 0.04, "speed": 0.1}
    """

    width: _Distance
    speed: _Positive = 0.1


class GraspEpsilon(RequestModel):
    """Tolerance of the width of a grasped object.

    Attributes:
        inner: How much narrower than expected the object may be [m].
        outer: How much wider than expected the object may be [m].
    """

    inner: _Distance = 0.005
    outer: _Distance = 0.005


class GripperGraspRequest(RequestModel):
    """Close, or open from within, until the fingers touch an object, and press it.

    Attributes:
        width: Expected width of the object, less than the largest one [m].
        force: Force of each finger, 0.1 to 140 [N].
        speed: How fast the width changes, at most 0.4 [m/s].
        epsilon: Tolerance of the width.

    Example:
        {"width": 0.03, "force": 20.0}
    """

    width: _Distance
    force: _Positive
    speed: _Positive = 0.1
    epsilon: GraspEpsilon = GraspEpsilon()


class HardwareComponentStateRequest(RequestModel):
    """Bring a hardware component into a state.

    Attributes:
        state: The state.
        stop_controllers: Whether to stop the controllers that command it first; without
            this, the request is refused while a controller commands it.

    Example:
        {"state": "inactive", "stop_controllers": true}
    """

    state: ComponentStateName
    stop_controllers: bool = False


class HardwareComponents(ResponseModel):
    """The hardware components.

    Attributes:
        components: One per part of the robot with a life cycle of its own.

    Example:
        {"components": [{"name": "left", "type": "system", "plugin":
         "franka_hw/FrankaHW", "state": "active", "problem": "", "command_interfaces":
         [{"hardware_interface": "hardware_interface::EffortJointInterface", "resource":
         "left_joint1", "is_available": true, "claimed_by": ["left_arm"]}],
         "state_interfaces": []}]}
    """

    components: Items[HardwareComponentReport]


class SoftLimits(ResponseModel):
    """Soft limits, which slow a joint down before its hard limits.

    Attributes:
        min_position: Lower bound [rad or m].
        max_position: Upper bound [rad or m].
        k_position: Velocity bound per distance to the soft bound [1/s].
        k_velocity: Effort bound per excess of velocity [Nm s/rad or N s/m].
    """

    min_position: Measured
    max_position: Measured
    k_position: float
    k_velocity: float


class HardwareLimits(ResponseModel):
    """Limits of a joint; null where it has none.

    Attributes:
        joint: Its name.
        min_position: Lower bound [rad or m].
        max_position: Upper bound [rad or m].
        max_velocity: In both directions [rad/s or m/s].
        max_acceleration: In both directions [rad/s^2 or m/s^2].
        max_jerk: In both directions [rad/s^3 or m/s^3].
        max_effort: In both directions [Nm or N].
        soft_limits: Soft limits; null without.
        sources: Source of each kind of limit; keys `position`, `velocity`,
            `acceleration`, `jerk`, `effort`, `soft`.
    """

    joint: str
    min_position: Measured
    max_position: Measured
    max_velocity: Measured
    max_acceleration: Measured
    max_jerk: Measured
    max_effort: Measured
    soft_limits: SoftLimits | None
    sources: Annotated[dict[str, str], Field(strict=False)]


class Clamp(ResponseModel):
    """Commands of a joint that limits have cut off: their number and the last one.

    Attributes:
        joint: Its name.
        hardware_interface: The interface that was commanded; `simulated brakes` when
            the brakes of a simulated joint have held its velocity.
        count: Number of cycles with such a command since the station started.
        asked: The last command that was cut off, in the unit of the interface.
        given: Command that the joint got instead.
        reason: The limit that was active.
    """

    joint: str
    hardware_interface: str
    count: int
    asked: Measured
    given: Measured
    reason: ClampReasonName


class HardwareRepair(ResponseModel):
    """A difference of the simulated robot from its description.

    Attributes:
        kind: Kind of the changed element.
        element: The element of the description.
        problem: Fault of the element.
        old: The value in the description; empty if there is none.
        new: Value that is used instead.
    """

    kind: RepairKindName
    element: str
    problem: str
    old: str
    new: str


class Hardware(ResponseModel):
    """The robot: the resources that controllers can claim, and their limits.

    Attributes:
        interfaces: Hardware interfaces with their resources.
        limits: Limits of the joints.
        transmissions: Transmissions; empty for a robot that has none.
        clamps: Commands that were cut off; empty if none ever was.
        repairs: Differences of a simulated robot from its description.

    Example:
        {"interfaces": [{"name": "hardware_interface::EffortJointInterface",
         "resources": [{"name": "elbow_joint", "claimed_by": ["arm"]}]}], "limits":
         [{"joint": "elbow_joint", "min_position": -3.14, "max_position": 3.14,
         "max_velocity": 3.15, "max_acceleration": null, "max_jerk": null, "max_effort":
         150.0, "soft_limits": null, "sources": {"position": "urdf limit", "velocity":
         "urdf limit", "effort": "parameters"}}], "transmissions": [{"name":
         "elbow_trans", "type": "transmission_interface/SimpleTransmission", "joints":
         ["elbow_joint"], "actuators": ["elbow_motor"]}], "clamps": [{"joint":
         "elbow_joint", "hardware_interface":
         "hardware_interface::EffortJointInterface", "count": 12, "asked": 400.0,
         "given": 150.0, "reason": "effort"}], "repairs": [{"kind": "range", "element":
         "joint 'wheel_joint'", "problem": "its range is empty", "old": "0 to 0", "new":
         "locked (zero_range: free lets it move)"}]}
    """

    interfaces: Items[HardwareInterface]
    limits: Items[HardwareLimits]
    transmissions: Items[HardwareTransmission]
    clamps: Items[Clamp]
    repairs: Items[HardwareRepair]
