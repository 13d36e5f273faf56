"""How a robot's root link is held in the world: fixed, floating or planar."""

from typing import Literal

import mujoco

BaseType = Literal["fixed", "floating", "planar"]
"""How the root link is held: not at all when it floats; upright, but free to move on
the floor when it is planar."""
BASE_JOINT = "base"
"""Name of a floating base's joint; a planar base's are `base_x`, `base_y`, `base_yaw`."""
PLANAR_JOINTS = ("base_x", "base_y", "base_yaw")


def add_base_joints(body: mujoco.MjsBody, base_type: BaseType) -> None:
    """Let the root link of a robot move in the world.

    Args:
        body: The root link's body, a child of the world.
        base_type: How it moves; `fixed` adds nothing.
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
