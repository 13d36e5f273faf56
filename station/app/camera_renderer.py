"""Draw the pictures of a station's cameras, in a process of its own.

The process reads lines from its standard input: first `Assignment` as JSON, then the
name of a camera whenever a client asks for pictures of it. For each picture it writes a
line of JSON with `name`, `stamp` and `size`, and then the bytes. A line with `error`
gives the reason why there are no pictures. The process ends when its input ends, or
after some time without requests.
"""

import asyncio
import io
import json
import math
import os
import sys
import time
from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
import yourdfpy
from numpy.typing import NDArray
from PIL import Image
from pydantic import BaseModel

from station.client import AsyncStationClient
from station.client.streams import AsyncStream
from station.config.models import CameraSection
from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Pose
from station.core.description.urdf_repair import repair_urdf
from station.core.geometry.scene import SceneObject
from station.hw.mujoco.model_builder import add_object
from station.wire import (
    JointStates,
    Scene,
    SceneObject as SeenObject,
    StreamFrame,
)

WANTED_FOR = 2.0
"""Time for which a camera is drawn after the last request for it [s]."""
IDLE_FOR = 60.0
"""Time without requests after which the process ends [s]."""
_NICENESS = 10
"""Niceness of this process: drawing must not delay other parts of the station."""
_QUALITY = 80
_GREY = (160, 160, 165)


class Assignment(BaseModel):
    """The work of a renderer.

    Attributes:
        url: The station's API.
        token: A viewer's token.
        robots: Description, prefix of the joints and base of each robot.
        cameras: The cameras by name.
    """

    url: str
    token: str
    robots: list[tuple[str, str, list[float]]]
    cameras: dict[str, CameraSection]


class DrawnRobot:
    """A robot with its visual meshes, at the newest joint positions.

    Args:
        description: `example-robot-data:<robot>` or the path of a URDF file.
        arm_id: Replaces `panda` in the names of a Panda.
        base: Pose of the root link: x, y, z [m], roll, pitch, yaw [rad].

    Raises:
        RobotDescriptionError: There is no such robot.
    """

    def __init__(self, description: str, arm_id: str, base: Sequence[float]) -> None:
        files = load_robot_files(description).with_prefix("panda_", f"{arm_id}_")

        def find(fname: str) -> str:
            return str(files.resolve_mesh(fname))

        self._robot = yourdfpy.URDF.load(
            io.BytesIO(repair_urdf(files.xml)[0].encode()),
            filename_handler=find,
            load_collision_meshes=False,
        )
        self.links: list[str] = list(self._robot.link_map)
        self._joints = set(self._robot.actuated_joint_names)
        x, y, z, *angles = base
        roll, pitch, yaw = angles
        self.base = _matrix(Pose.from_rpy((x, y, z), (roll, pitch, yaw)))
        self.root: str = self._robot.base_link

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add a body for each link; its shapes are the visual meshes."""
        for link in self.links:
            spec.worldbody.add_body(name=link, mocap=True)
        scene = self._robot.scene
        for node in scene.graph.nodes_geometry:
            place, name = scene.graph[node]
            link = scene.graph.transforms.parents[node]
            mesh = scene.geometry[name]
            if spec.mesh(f"{link}/{name}") is None:
                asset = spec.add_mesh(name=f"{link}/{name}")
                asset.uservert = mesh.vertices.ravel().tolist()
                asset.userface = mesh.faces.ravel().tolist()
                # Visual meshes may be flat or open, for which only shell inertia is
                # defined.
                asset.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            pose = np.linalg.inv(self._robot.get_transform(link)) @ place
            spec.body(link).add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=f"{link}/{name}",
                pos=pose[:3, 3],
                quat=_quaternion(pose),
                rgba=_paint_of(mesh.visual),
                contype=0,
                conaffinity=0,
            )

    def move(self, states: JointStates) -> None:
        """Move the joints; a joint without a finite position stays."""
        pairs = zip(states.name, states.position, strict=True)
        self._robot.update_cfg({
            joint: value
            for joint, value in pairs
            if value is not None and joint in self._joints
        })

    def poses(self) -> dict[str, NDArray[np.float64]]:
        """Return the pose of each link in the world, shape (4, 4)."""
        get = self._robot.get_transform
        return {link: self.base @ get(link) for link in self.links}


class Stage:
    """All that cameras see, as a model of MuJoCo that sets poses and runs no steps.

    Args:
        robots: The robots.
        cameras: The cameras by name.

    Raises:
        ValueError: A camera is mounted to a frame that no robot has.
    """

    def __init__(
        self, robots: Sequence[DrawnRobot], cameras: Mapping[str, CameraSection]
    ) -> None:
        self._robots = robots
        self._cameras = cameras
        self._built_for: object = None
        self._renderers: dict[tuple[int, int], mujoco.Renderer] = {}
        frames = {link for robot in robots for link in robot.links}
        for name, camera in cameras.items():
            if camera.frame and camera.frame not in frames:
                raise ValueError(
                    f"The camera '{name}' hangs on '{camera.frame}', which no robot "
                    f"has. There are {', '.join(sorted(frames))}."
                )

    def draw(self, name: str, states: JointStates, scene: Scene) -> NDArray[np.uint8]:
        """Return the picture of a camera, shape (height, width, 3)."""
        # A camera sees solid objects only, and no zones that arms keep out of.
        things = [one for one in scene.objects if one.solid]
        key = [(one.name, one.type, one.size, one.file, one.colour) for one in things]
        if self._built_for != key:
            self._build(things)
            self._built_for = key
        self._place(states, scene, things)
        camera = self._cameras[name]
        size = camera.height, camera.width
        if size not in self._renderers:
            self._renderers[size] = mujoco.Renderer(self._model, *size)
        renderer = self._renderers[size]
        renderer.update_scene(self._data, f"camera {name}")
        pixels: NDArray[np.uint8] = renderer.render()
        return pixels

    def _build(self, things: Sequence[SeenObject]) -> None:
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers.clear()
        spec = _lit_floor()
        for robot in self._robots:
            robot.add_to(spec)
        for one in things:
            size = tuple(one.size)
            add_object(spec, SceneObject(one.name, one.type, size, file=one.file))
            body = spec.body(one.name)
            body.mocap = True
            paint = [part / 255.0 for part in one.colour or _GREY]
            body.geoms[0].rgba = [*paint, 1.0]
        for name, camera in self._cameras.items():
            body = spec.body(camera.frame) if camera.frame else spec.worldbody
            body.add_camera(
                name=f"camera {name}",
                pos=camera.position,
                quat=_quaternion(looking(camera)),
                fovy=math.degrees(camera.fov),
            )
        whole = spec.visual.global_
        whole.offwidth = max(camera.width for camera in self._cameras.values())
        whole.offheight = max(camera.height for camera in self._cameras.values())
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)

    def _place(
        self, states: JointStates, scene: Scene, things: Sequence[SeenObject]
    ) -> None:
        bases = {base.link: base for base in scene.bases}
        for robot in self._robots:
            base = bases.get(robot.root)
            if base is not None:
                robot.base = _matrix(_pose(base.position, base.orientation))
            robot.move(states)
            for link, pose in robot.poses().items():
                self._put(link, pose[:3, 3], _quaternion(pose))
        for one in things:
            place = _pose(one.position, one.orientation)
            self._put(one.name, place.xyz, place.quaternion)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _put(
        self,
        body: str,
        position: Sequence[float] | NDArray[np.float64],
        quaternion: Sequence[float] | NDArray[np.float64],
    ) -> None:
        i = int(self._model.body(body).mocapid[0])
        self._data.mocap_pos[i] = position
        self._data.mocap_quat[i] = quaternion


def looking(camera: CameraSection) -> NDArray[np.float64]:
    """Return the axes of a camera in its frame: x to the right, y up, -z to its target.

    Args:
        camera: The camera.

    Returns:
        A rotation, shape (3, 3).
    """
    back = np.subtract(camera.position, camera.target)
    right = np.cross(camera.up, back)
    back = back / np.linalg.norm(back)
    right = right / np.linalg.norm(right)
    return np.column_stack([right, np.cross(back, right), back])


def _lit_floor() -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.compiler.autolimits = False
    # MuJoCo draws objects between two shares of the extent only. Set them so that a
    # camera in a hand sees the fingers, and other cameras the whole hall, however small
    # the robot is.
    spec.stat.extent = 1.0
    spec.visual.map.znear, spec.visual.map.zfar = 0.01, 50.0
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.specular = [0.0, 0.0, 0.0]
    lamp = spec.worldbody.add_light(
        dir=[0.3, 0.2, -1.0], type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    )
    # A map of shadows would be too coarse for an endless floor, and takes half of the
    # time.
    lamp.castshadow, lamp.specular = False, [0.1, 0.1, 0.1]
    for kind, builtin, size in (
        (mujoco.mjtTexture.mjTEXTURE_SKYBOX, mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, 64),
        (mujoco.mjtTexture.mjTEXTURE_2D, mujoco.mjtBuiltin.mjBUILTIN_CHECKER, 128),
    ):
        sky = kind == mujoco.mjtTexture.mjTEXTURE_SKYBOX
        spec.add_texture(
            name=kind.name,
            type=kind,
            builtin=builtin,
            rgb1=[0.9, 0.93, 0.96] if sky else [0.64, 0.66, 0.68],
            rgb2=[0.7, 0.75, 0.8] if sky else [0.57, 0.59, 0.61],
            width=size,
            height=6 * size if sky else size,
        )
    tiles = spec.add_material(name="tiles", texrepeat=[2.0, 2.0], texuniform=True)
    tiles.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "mjTEXTURE_2D"
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 0.1], material="tiles"
    )
    return spec


def _paint_of(visual: object) -> list[float]:
    """Return the colour of a mesh, with its opacity, 0 to 1."""
    owner = getattr(visual, "material", visual)
    return [float(part) / 255.0 for part in getattr(owner, "main_color", (*_GREY, 255))]


def _quaternion(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(pose[:3, :3]).ravel())
    return quaternion


def _matrix(pose: Pose) -> NDArray[np.float64]:
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, np.array(pose.quaternion))
    made = np.eye(4)
    made[:3, :3] = rotation.reshape(3, 3)
    made[:3, 3] = pose.xyz
    return made


def _pose(
    position: Sequence[float | None], orientation: Sequence[float | None]
) -> Pose:
    """Return a pose of the wire; the origin if a reading is not finite."""
    values = [value for value in (*position, *orientation) if value is not None]
    if len(values) < 7:
        return Pose()
    px, py, pz, x, y, z, w = values
    return Pose((px, py, pz), (w, x, y, z))


class Renderer:
    """Draws the requested cameras, and writes their pictures.

    Args:
        assignment: The station, its robots and its cameras.

    Raises:
        ValueError: A camera is mounted to a frame that no robot has.
    """

    def __init__(self, assignment: Assignment) -> None:
        self._assignment = assignment
        robots = [DrawnRobot(*robot) for robot in assignment.robots if robot[0]]
        self._stage = Stage(robots, assignment.cameras)
        self._seen: dict[str, StreamFrame] = {}
        self._wanted_until = dict.fromkeys(assignment.cameras, 0.0)
        self._due_at = dict.fromkeys(assignment.cameras, 0.0)
        self._idle_at = time.monotonic() + IDLE_FOR

    async def run(self) -> None:
        """Draw until the input ends, or until no request has come for `IDLE_FOR`."""
        fastest = max(camera.rate for camera in self._assignment.cameras.values())
        async with AsyncStationClient(
            self._assignment.url, self._assignment.token
        ) as client:
            followed = (("joint_states", fastest), ("scene", fastest))
            tasks = [
                asyncio.create_task(self._follow(client.stream(topic, rate=rate)))
                for topic, rate in followed
            ]
            listening = asyncio.create_task(self._listen())
            while not listening.done() and time.monotonic() < self._idle_at:
                self._draw_due()
                await asyncio.sleep(0.005)
                for task in tasks:
                    if task.done():
                        task.result()  # raises the error that ended the stream
            for task in (*tasks, listening):
                task.cancel()

    async def _follow(self, stream: AsyncStream) -> None:
        async for frame in stream:
            self._seen[frame.topic] = frame

    async def _listen(self) -> None:
        reader = asyncio.StreamReader()
        await asyncio.get_running_loop().connect_read_pipe(
            lambda: asyncio.StreamReaderProtocol(reader), sys.stdin
        )
        while line := await reader.readline():
            now = time.monotonic()
            self._wanted_until[line.decode().strip()] = now + WANTED_FOR
            self._idle_at = now + IDLE_FOR

    def _draw_due(self) -> None:
        if len(self._seen) < 2:
            return
        joints, scene = self._seen["joint_states"], self._seen["scene"]
        for name, camera in self._assignment.cameras.items():
            now = time.monotonic()
            if not self._due_at[name] <= now < self._wanted_until[name]:
                continue
            self._due_at[name] = now + 1.0 / camera.rate
            states = joints.read(JointStates)
            pixels = self._stage.draw(name, states, scene.read(Scene))
            picture = io.BytesIO()
            Image.fromarray(pixels).save(picture, "JPEG", quality=_QUALITY)
            _write(picture.getvalue(), name=name, stamp=states.stamp)


def _write(content: bytes, **header: object) -> None:
    line = json.dumps({**header, "size": len(content)}).encode()
    sys.stdout.buffer.write(line + b"\n" + content)
    sys.stdout.buffer.flush()


def main() -> None:
    """Read the assignment from the standard input, and draw."""
    os.nice(_NICENESS)
    assignment = Assignment.model_validate_json(sys.stdin.readline())
    asyncio.run(Renderer(assignment).run())


if __name__ == "__main__":
    try:
        main()
    except Exception as error:  # noqa: BLE001 - every error must reach people
        _write(b"", error=" ".join(f"{type(error).__name__}: {error}".split()))
