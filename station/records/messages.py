"""Message types of a recording as `ros2msg` definitions, and transforms of links.

Source: ros2/common_interfaces@humble sensor_msgs, std_msgs, geometry_msgs and tf2_msgs;
franka_ros@c11f000 franka_msgs/msg/FrankaState.msg and Errors.msg; differs: names of
fields are in lower case, as ROS 2 wants them and franka_ros2 has them.
`control_station_msgs` is the station's own.
"""

from collections.abc import Mapping
from math import cos, sin

from station.core.description.urdf import Joint, JointType, Pose, Urdf
from station.core.franka.franka_errors import ERROR_NAMES
from station.records.cdr import MessageType, Values

_SEPARATOR = "=" * 80
_TIME = "int32 sec\nuint32 nanosec\n"
_HEADER = "builtin_interfaces/Time stamp\nstring frame_id\n"
ERROR_ORDER = (*range(23), *range(27, 32), 23, 32, 24, 25, 26, *range(33, 41))
"""Index into `ERROR_NAMES` (libfranka's order) for each flag of franka_msgs/Errors.msg.
A message has no names of its fields, so the order must be that of the definition."""
_PARTS = {
    "builtin_interfaces/Time": _TIME,
    "std_msgs/Header": _HEADER,
    "franka_msgs/Errors": "".join(f"bool {ERROR_NAMES[k]}\n" for k in ERROR_ORDER),
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Transform": (
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"
    ),
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/Transform transform\n"
    ),
}


def _message_type(name: str, text: str) -> MessageType:
    """Return a type whose text has the definition of every type in it once."""
    found: list[str] = []
    pending = [text]
    while pending:
        words = pending.pop().split()
        for word in words:
            part = word.partition("[")[0]
            if part in _PARTS and part not in found:
                found.append(part)
                pending.append(_PARTS[part])
    parts = "".join(f"{_SEPARATOR}\nMSG: {one}\n{_PARTS[one]}" for one in found)
    return MessageType(name, text + parts)


JOINT_STATE = _message_type(
    "sensor_msgs/msg/JointState",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
    "float64[] effort\n",
)
STRING = _message_type("std_msgs/msg/String", "string data\n")
TF_MESSAGE = _message_type(
    "tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"
)
CYCLE = _message_type(
    "control_station_msgs/msg/Cycle",
    "std_msgs/Header header\nuint64 cycle\nuint64 epoch\nfloat64 time\n"
    "float64 period\nstring mode\n",
)
JOINT_COMMANDS = _message_type(
    "control_station_msgs/msg/JointCommands",
    "std_msgs/Header header\nstring[] name\nfloat64[] command\n",
)
CONTROLLER_STATE = _message_type(
    "control_station_msgs/msg/ControllerState",
    "std_msgs/Header header\nstring[] name\nfloat64[] desired\nfloat64[] actual\n"
    "float64[] error\nfloat64[] output\n",
)
CLEARANCE = _message_type(
    "control_station_msgs/msg/Clearance",
    "std_msgs/Header header\nstring link\nstring object\nfloat64 distance\n"
    "float64 margin\nbool is_slowing\nuint64 interventions\n",
)
EVENT = _message_type(
    "control_station_msgs/msg/Event",
    "std_msgs/Header header\nstring kind\nstring severity\nstring text\n"
    "string details\n",
)
FRANKA_STATE = _message_type(
    "franka_msgs/msg/FrankaState",
    "std_msgs/Header header\n"
    "float64[6] cartesian_collision\nfloat64[6] cartesian_contact\n"
    "float64[7] q\nfloat64[7] q_d\nfloat64[7] dq\nfloat64[7] dq_d\n"
    "float64[7] ddq_d\nfloat64[7] theta\nfloat64[7] dtheta\nfloat64[7] tau_j\n"
    "float64[7] dtau_j\nfloat64[7] tau_j_d\nfloat64[6] k_f_ext_hat_k\n"
    "float64[2] elbow\nfloat64[2] elbow_d\nfloat64[2] elbow_c\n"
    "float64[2] delbow_c\nfloat64[2] ddelbow_c\nfloat64[7] joint_collision\n"
    "float64[7] joint_contact\nfloat64[6] o_f_ext_hat_k\nfloat64[6] o_dp_ee_d\n"
    "float64[3] o_ddp_o\nfloat64[6] o_dp_ee_c\nfloat64[6] o_ddp_ee_c\n"
    "float64[7] tau_ext_hat_filtered\nfloat64 m_ee\nfloat64[3] f_x_cee\n"
    "float64[9] i_ee\nfloat64 m_load\nfloat64[3] f_x_cload\nfloat64[9] i_load\n"
    "float64 m_total\nfloat64[3] f_x_ctotal\nfloat64[9] i_total\n"
    "float64[16] o_t_ee\nfloat64[16] o_t_ee_d\nfloat64[16] o_t_ee_c\n"
    "float64[16] f_t_ee\nfloat64[16] f_t_ne\nfloat64[16] ne_t_ee\n"
    "float64[16] ee_t_k\nfloat64 time\nfloat64 control_command_success_rate\n"
    "uint8 ROBOT_MODE_OTHER=0\nuint8 ROBOT_MODE_IDLE=1\nuint8 ROBOT_MODE_MOVE=2\n"
    "uint8 ROBOT_MODE_GUIDING=3\nuint8 ROBOT_MODE_REFLEX=4\n"
    "uint8 ROBOT_MODE_USER_STOPPED=5\n"
    "uint8 ROBOT_MODE_AUTOMATIC_ERROR_RECOVERY=6\nuint8 robot_mode\n"
    "franka_msgs/Errors current_errors\nfranka_msgs/Errors last_motion_errors\n",
)

TYPES = {
    one.name: one
    for one in (
        JOINT_STATE,
        STRING,
        TF_MESSAGE,
        CYCLE,
        JOINT_COMMANDS,
        CONTROLLER_STATE,
        CLEARANCE,
        EVENT,
        FRANKA_STATE,
    )
}
"""All message types by name."""


def header(stamp: int, frame_id: str = "") -> dict[str, object]:
    """Return a `std_msgs/Header`.

    Args:
        stamp: Time [ns since 1970]. A float with seconds since 1970 would round it to
            240 ns.
        frame_id: Name of the frame of the message.
    """
    seconds, rest = divmod(stamp, 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": frame_id}


def joint_pose(joint: Joint, position: float) -> Pose:
    """Return the pose of a joint's child in its parent.

    Args:
        joint: The joint.
        position: Its position [rad or m]; joints without one stay at their origin.
    """
    if joint.type.is_rotation:
        half = position / 2.0
        x, y, z = (sin(half) * axis for axis in joint.axis)
        return joint.origin.compose(Pose(quaternion=(cos(half), x, y, z)))
    if joint.type is JointType.PRISMATIC:
        x, y, z = (position * axis for axis in joint.axis)
        return joint.origin.compose(Pose((x, y, z)))
    return joint.origin


def transforms(urdf: Urdf, positions: Mapping[str, float], stamp: int) -> Values:
    """Return a `tf2_msgs/TFMessage` with a transform for every joint.

    Args:
        urdf: The robot.
        positions: Positions by joint [rad or m]; others are at zero, and those that
            mimic another joint follow it.
        stamp: Time of the transforms [ns].
    """
    return {
        "transforms": [
            stamped_transform(
                joint.parent,
                joint.child,
                joint_pose(joint, joint_position(joint, positions)),
                stamp,
            )
            for joint in urdf.joints.values()
        ]
    }


def joint_position(joint: Joint, positions: Mapping[str, float]) -> float:
    """Return a joint's position [rad or m], from positions as in `transforms`."""
    if joint.name in positions:
        return positions[joint.name]
    mimic = joint.mimic
    if mimic is None:
        return 0.0
    return mimic.multiplier * positions.get(mimic.joint, 0.0) + mimic.offset


def stamped_transform(parent: str, child: str, pose: Pose, stamp: int) -> Values:
    """Return a `geometry_msgs/TransformStamped` of a frame in its parent."""
    x, y, z = pose.xyz
    qw, qx, qy, qz = pose.quaternion
    return {
        "header": header(stamp, parent),
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
        },
    }
