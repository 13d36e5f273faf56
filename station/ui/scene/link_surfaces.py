"""The collision geometry of a robot's links as surfaces that can be drawn."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray

from station.core.description.urdf import Pose, Shape, Urdf


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A surface of triangles.

    Attributes:
        vertices: Their corners [m], shape (n, 3).
        faces: Three indices of corners for each triangle, shape (m, 3).
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]

    def draw(
        self,
        scene: viser.SceneApi,
        path: str,
        colour: tuple[int, int, int],
        opacity: float,
        *,
        scale: float = 1.0,
        is_flat: bool = True,
    ) -> viser.MeshHandle:
        """Draw the surface, translucent.

        Args:
            scene: Scene that shows it.
            path: Its scene node.
            colour: Its colour.
            opacity: 0 to 1.
            scale: Its size over its real size.
            is_flat: Whether each triangle is of one shade.
        """
        # Without shadows, which would draw the surface four times.
        return scene.add_mesh_simple(
            path,
            self.vertices,
            self.faces,
            color=colour,
            opacity=opacity,
            scale=scale,
            flat_shading=is_flat,
            cast_shadow=False,
            receive_shadow=False,
        )


def link_surfaces(
    urdf: Urdf, resolve_mesh: Callable[[str], Path]
) -> dict[str, Surface]:
    """Return the collision geometry of each link that has some, in the link's frame.

    Args:
        urdf: The robot.
        resolve_mesh: Returns the file of a mesh.

    Raises:
        ValueError: A mesh is in no known format.
        OSError: A mesh cannot be read.
    """
    return {
        link.name: _joined([_drawn(shape, resolve_mesh) for shape in link.collisions])
        for link in urdf.links.values()
        if link.collisions
    }


def bounds_of(
    surfaces: Mapping[str, Surface], poses: Mapping[str, Pose]
) -> NDArray[np.float64] | None:
    """Return the smallest box around a robot.

    Args:
        surfaces: Surfaces by link.
        poses: Pose of each of these links.

    Returns:
        Lowest and highest corner [m], shape (2, 3); None without any surface.
    """
    if not surfaces:
        return None
    points = np.concatenate([
        placed(surface.vertices, poses[link]) for link, surface in surfaces.items()
    ])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def placed(points: NDArray[np.floating], pose: Pose) -> NDArray[np.float64]:
    """Return points of a frame in its parent.

    Args:
        points: Points [m], shape (n, 3).
        pose: The frame in its parent.
    """
    w, x, y, z = pose.quaternion
    axis = np.array([x, y, z])
    # v + 2 w (a x v) + 2 a x (a x v) turns v by a unit quaternion (w, a).
    turn = 2.0 * np.cross(axis, points)
    moved: NDArray[np.float64] = points + w * turn + np.cross(axis, turn) + pose.xyz
    return moved


def _drawn(shape: Shape, resolve_mesh: Callable[[str], Path]) -> Surface:
    scale = (1.0, 1.0, 1.0)
    match shape.kind:
        case "box":
            mesh = trimesh.creation.box(extents=shape.size)
        case "sphere":
            mesh = trimesh.creation.icosphere(subdivisions=2, radius=shape.size[0])
        case "cylinder":
            radius, height = shape.size
            mesh = trimesh.creation.cylinder(radius=radius, height=height, sections=24)
        case _:
            mesh = trimesh.load_mesh(str(resolve_mesh(str(shape.mesh))))
            scale = (shape.size[0], shape.size[1], shape.size[2])
    vertices = placed(np.asarray(mesh.vertices) * scale, shape.origin)
    faces = np.asarray(mesh.faces, dtype=np.uint32)
    # A mirrored surface would show its inner side.
    is_mirrored = float(np.prod(scale)) < 0.0
    return Surface(
        vertices.astype(np.float32), faces[:, ::-1] if is_mirrored else faces
    )


def _joined(parts: list[Surface]) -> Surface:
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Surface(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([
            part.faces + start for part, start in zip(parts, first, strict=False)
        ]).astype(np.uint32),
    )
