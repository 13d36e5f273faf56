"""The mount of a robot's root link in the world: fixed, floating or planar.

A planar base stands upright and moves on the floor as its wheels roll without slipping:
with the velocity v along its x axis and the yaw rate w,

    v = (v_left + v_right) / 2,    w = (v_right - v_left) / separation,

where v_left and v_right are the mean rolling speeds of the wheels on either side.
"""

from collections.abc import Sequence
from math import cos, sin
from typing import TYPE_CHECKING, Literal

import mujoco
from typing_extensions import override

from station.core.description.urdf import JointType, Pose, Urdf, multiply, wheel_radius
from station.core.errors import RobotDescriptionError
from station.core.hardware.robot_report import MovingBaseReport
from station.hw.mujoco.world_step import Preparation

if TYPE_CHECKING:
    from station.hw.mujoco.world import World

BaseType = Literal["fixed", "floating", "planar"]
"""How the root link is held: `fixed` to the world; `floating`, not held at all; or
`planar`, upright but free to move on the floor."""
BASE_JOINT = "base"
"""Name of a floating base's joint; a planar base has those in `PLANAR_JOINTS`."""
PLANAR_JOINTS = ("base_x", "base_y", "base_yaw")
# Damping of the servos that make a planar base follow its wheels [N s/m], [Nm s/rad]. A
# robot of 100 kg follows within 0.1 ms, and a push of 1 kN moves it at 1 mm/s.
_STIFFNESS = 1e6
# Cosine of the largest angle between a wheel's axis and the base's lateral axis; it
# excludes rollers and casters.
_ACROSS = 0.95


def add_base_joints(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, base_type: BaseType
) -> None:
    """Let the root link of a robot move in the world.

    Args:
        spec: The world; changed.
        body: The root link's body, a child of the world.
        base_type: How the root link is held; `fixed` adds no joint.
    """
    if base_type == "floating":
        body.add_freejoint(name=BASE_JOINT)
    elif base_type == "planar":
        kinds = mujoco.mjtJoint
        for name, kind, axis in zip(
            PLANAR_JOINTS,
            (kinds.mjJNT_SLIDE, kinds.mjJNT_SLIDE, kinds.mjJNT_HINGE),
            ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
            strict=True,
        ):
            body.add_joint(name=name, type=kind, axis=axis)
            servo = spec.add_actuator(
                name=name,
                target=name,
                trntype=mujoco.mjtTrn.mjTRN_JOINT,
                gaintype=mujoco.mjtGain.mjGAIN_FIXED,
                biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            )
            servo.gainprm[0] = _STIFFNESS
            servo.biasprm[2] = -_STIFFNESS


def joints_of_base(base_type: BaseType) -> tuple[str, ...]:
    """Return the joints with one degree of freedom by which a base moves."""
    return PLANAR_JOINTS if base_type == "planar" else ()


def moving_bases(model: mujoco.MjModel, data: mujoco.MjData) -> list[MovingBaseReport]:
    """Return the poses of the root links that are not fixed. World's thread only."""
    found = []
    for name, kind in (
        (BASE_JOINT, mujoco.mjtJoint.mjJNT_FREE),
        (PLANAR_JOINTS[0], mujoco.mjtJoint.mjJNT_SLIDE),
    ):
        joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        if joint < 0 or model.jnt_type[joint] != kind:
            continue
        body = data.body(int(model.jnt_bodyid[joint]))
        w, x, y, z = body.xquat.tolist()
        place = tuple(body.xpos.tolist())
        found.append(MovingBaseReport(body.name, place, (x, y, z, w)))
    return found


class RollingBase(Preparation):
    """Lets a planar base follow its wheels. Acts in the world before every step.

    Args:
        world: The simulated world.
        urdf: The robot. Its wheels are the joints without a range that have `wheel` in
            their name and an axis across the root link.

    Raises:
        RobotDescriptionError: The robot lacks wheels on a side, or the radius of a
            wheel is not known.
    """

    def __init__(self, world: "World", urdf: Urdf) -> None:
        model, data = world.model, world.data
        wheels = _find_wheels(urdf)
        sides = [[w for w in wheels if w[1] > 0.0], [w for w in wheels if w[1] < 0.0]]
        if not all(sides):
            raise RobotDescriptionError(
                f"The robot '{urdf.name}' has no wheels on both sides of its root "
                f"link; found are {', '.join(w[0] for w in wheels) or 'none'}.",
                remedy="Set robot.base to fixed or floating.",
            )
        left, right = (sum(w[1] for w in side) / len(side) for side in sides)
        self._separation = left - right
        self._sides = [
            [
                (int(model.joint(name).dofadr[0]), rate / len(side))
                for name, _, rate in side
            ]
            for side in sides
        ]
        self._yaw = int(model.joint(PLANAR_JOINTS[2]).qposadr[0])
        self._servos = [int(model.actuator(name).id) for name in PLANAR_JOINTS]
        self._qvel, self._qpos, self._control = data.qvel, data.qpos, data.ctrl

    @override
    def prepare_step(self) -> None:
        """Command the servos of the base to follow the wheels."""
        qvel = self._qvel
        left, right = (
            sum(float(qvel[dof]) * rate for dof, rate in side) for side in self._sides
        )
        forward, yaw = (left + right) / 2.0, float(self._qpos[self._yaw])
        x, y, turn = self._servos
        self._control[x] = forward * cos(yaw)
        self._control[y] = forward * sin(yaw)
        self._control[turn] = (right - left) / self._separation


def _find_wheels(urdf: Urdf) -> Sequence[tuple[str, float, float]]:
    """Return name, lateral place [m] and rolling rate [m/rad] of each wheel."""
    found = []
    for name, joint in urdf.joints.items():
        if joint.type is not JointType.CONTINUOUS or "wheel" not in name.lower():
            continue
        pose = _pose_in_root(urdf, joint.parent).compose(joint.origin)
        across = _turned(pose, joint.axis)[1]
        if abs(across) > _ACROSS:
            radius = wheel_radius(urdf, name)
            found.append((name, pose.xyz[1], radius if across > 0.0 else -radius))
    return found


def _pose_in_root(urdf: Urdf, link: str) -> Pose:
    pose, above = Pose(), urdf.joint_above(link)
    while above is not None:
        pose = above.origin.compose(pose)
        above = urdf.joint_above(above.parent)
    return pose


def _turned(pose: Pose, vector: tuple[float, float, float]) -> tuple[float, ...]:
    w, x, y, z = pose.quaternion
    turned = multiply(multiply(pose.quaternion, (0.0, *vector)), (w, -x, -y, -z))
    return turned[1:]
