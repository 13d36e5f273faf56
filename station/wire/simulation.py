"""Wire models of the simulation: time, scene and contacts."""

import math
from typing import Literal

from pydantic import AliasChoices, Field, field_validator

from station.reports import CameraReport, Clearance
from station.wire.base import Items, Measurements, RequestModel, ResponseModel

_ROUNDING = 1e-3
"""How far the length of a unit quaternion may be from 1: clients round its numbers."""


class SimulationPatch(RequestModel):
    """Pause, resume, or change the pace; a field left out keeps its value.

    Attributes:
        paused: Whether station time is to stand still.
        real_time_factor: Station time over wall time, 0.01 to 100.

    Example:
        {"paused": true}
    """

    paused: bool | None = None
    real_time_factor: float | None = None


class StepRequest(RequestModel):
    """Run some cycles of a paused simulation.

    Attributes:
        n: How many, 1 to 10000.

    Example:
        {"n": 100}
    """

    n: int = 1


class ResetRequest(RequestModel):
    """Put the world back to its start.

    Attributes:
        keyframe: Name of a pose to begin at; null for where the joints began.
        joint_positions: Joint name to position [rad] or [m]; the others go to the
            keyframe, or back to where they began.

    Example:
        {"keyframe": "ready", "joint_positions": {"panda_joint1": 0.5}}
    """

    keyframe: str | None = Field(default=None, min_length=1, max_length=128)

    joint_positions: dict[str, float] = Field(default_factory=dict)


ObjectKind = Literal[
    "box", "sphere", "cylinder", "capsule", "half_space", "table", "mesh"
]
Role = Literal["object", "keep_out", "fence"]


class SceneObjectRequest(RequestModel):
    """Add an object with a role, or change one; a field left out keeps its value.

    Attributes:
        type: Kind of object; a new one needs it.
        size: Edges of a box or table; radius of a sphere; radius and height of a
            cylinder; radius of a capsule and length of its axis [m].
        position: Position of its middle; for a table, of the middle of its top [m].
        rpy: Roll, pitch and yaw [rad].
        orientation: Unit quaternion x, y, z, w, in place of `rpy`.
        role: Role for the robots; a new object has keep_out or fence.
        margin: Distance that arms keep from it [m].
        links: Links for which the role counts, `hand` for the hand only; empty for
            all.
        colour: Red, green and blue, 0 to 255; empty for the one of its role.
        file: STL or OBJ file of a mesh, on the station's machine.

    Example:
        {"type": "box", "size": [0.1, 1.0, 1.0], "position": [0.6, 0.0, 0.5], "role":
         "keep_out", "margin": 0.02}
    """

    type: ObjectKind | None = None
    size: list[float] = Field(default_factory=list, max_length=3)
    position: list[float] = Field(default_factory=list, max_length=3)
    rpy: list[float] = Field(default_factory=list, max_length=3)
    orientation: list[float] | None = Field(default=None, min_length=4, max_length=4)
    role: Role | None = None
    margin: float | None = None
    links: list[str] = Field(default_factory=list, max_length=16)
    colour: list[float] = Field(default_factory=list, max_length=3)
    file: str = ""

    @field_validator("orientation")
    @classmethod
    def _is_a_rotation(cls, value: list[float] | None) -> list[float] | None:
        # Written with `not`, so that NaN is refused, too.
        if value is not None and not abs(math.hypot(*value) - 1.0) < _ROUNDING:
            raise ValueError("must have length 1")
        return value


class SceneObject(ResponseModel):
    """An object at its present pose.

    Attributes:
        name: Its name.
        type: Kind of object; a table is a box.
        size: Edges of a box or table; radius of a sphere; radius and height of a
            cylinder [m]; empty for a mesh.
        position: Position of its middle in the world [m], shape (3,).
        orientation: Unit quaternion x, y, z, w.
        mass: Mass [kg]; 0 for an object that cannot move.
        file: File of a mesh, on the station's machine.
        role: `keep_out`: arms keep clear of it; `fence`: they stay inside.
        margin: Distance that arms keep from it [m]; without effect for the role
            `object`.
        links: Links for which the role counts; empty for all.
        colour: Red, green and blue, 0 to 255; empty for the one of its role.
        solid: Whether a simulated robot can touch it.
        carried_by: Name of the arm whose hand carries it; empty for none.

    Example:
        {"name": "cube", "type": "box", "size": [0.05, 0.05, 0.05], "position": [0.5,
         0.0, 0.025], "orientation": [0.0, 0.0, 0.0, 1.0], "mass": 0.1, "file": ""}
    """

    name: str
    type: ObjectKind = Field(validation_alias=AliasChoices("type", "kind"))
    size: Items[float]
    position: Measurements = Field(min_length=3, max_length=3)
    orientation: Measurements = Field(min_length=4, max_length=4)
    mass: float
    file: str = ""
    role: Role = "object"
    margin: float = 0.0
    links: Items[str] = Field(default_factory=list)
    colour: Items[int] = Field(default_factory=list)
    solid: bool = True
    carried_by: str = ""


class AttachRequest(RequestModel):
    """Let an arm carry an object.

    Attributes:
        arm: Name of the arm; may be left out where there is only one.
        load: Whether to set the load of the arm, too; an arm that moves refuses this.

    Example:
        {"arm": "panda"}
    """

    arm: str = Field(default="", max_length=128)
    load: bool = True


class DetachRequest(RequestModel):
    """Let an arm put an object down: the object stays where it is.

    Attributes:
        load: Whether to set the load of the arm to the objects that it still carries;
            an arm that moves refuses this.

    Example:
        {"load": true}
    """

    load: bool = True


class SavedScenes(ResponseModel):
    """The saved scenes.

    Attributes:
        scenes: Names of the scenes, sorted.
    """

    scenes: Items[str]


class MovingBase(ResponseModel):
    """Present pose of the root link of a simulated robot that floats or drives.

    Attributes:
        link: Name of the root link.
        position: Position of its frame in the world [m], shape (3,).
        orientation: Unit quaternion x, y, z, w.

    Example:
        {"link": "base_footprint", "position": [0.8, -0.1, 0.0], "orientation": [0.0,
         0.0, 0.1, 0.995]}
    """

    link: str
    position: Measurements = Field(min_length=3, max_length=3)
    orientation: Measurements = Field(min_length=4, max_length=4)


class Contact(ResponseModel):
    """A point at which two bodies of a simulated world touch.

    Attributes:
        bodies: Names of the two links or objects; `world` is the floor.
        position: The point, in the world [m], shape (3,).
        force: Force on the second body in the last step, in axes of the world [N],
            shape (3,); the first body feels the opposite force.

    Example:
        {"bodies": ["world", "cube"], "position": [0.5, 0.02, 0.0], "force": [0.0, 0.0,
         0.25]}
    """

    bodies: Items[str] = Field(min_length=2, max_length=2)
    position: Measurements = Field(min_length=3, max_length=3)
    force: Measurements = Field(min_length=3, max_length=3)


class Scene(ResponseModel):
    """All objects in the world besides robots, and the contacts.

    Attributes:
        objects: The objects; empty when there are none, and around a real robot.
        contacts: The contacts, 64 at most; empty around a real robot, which has no
            sensors for them.
        clearances: The nearest pair of each arm that keeps clear of objects.
        bases: Poses of the root links of simulated robots with a floating or planar
            base; empty where all robots are fixed.
    """

    objects: Items[SceneObject]
    contacts: Items[Contact] = Field(default_factory=list)
    bases: Items[MovingBase] = Field(default_factory=list)
    clearances: Items[Clearance] = Field(default_factory=list)


class Cameras(ResponseModel):
    """The cameras that look at the robots.

    Attributes:
        cameras: The cameras, in the order of the configuration.

    Example:
        {"cameras": [{"name": "cell", "frame": "", "width": 320, "height": 240, "rate":
         5.0, "fault": ""}]}
    """

    cameras: Items[CameraReport]
