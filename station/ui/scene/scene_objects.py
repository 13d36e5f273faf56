"""Draw the objects around a simulated robot once, then move them."""

from collections.abc import Sequence
from pathlib import Path

import trimesh
import viser

from station.wire import SceneObject

_ROOT = "/scene"
_SMALLEST_STEP = 1e-4
"""Smallest change of a position [m] or of a quaternion that is shown."""
_FIXED = (176, 160, 140)
_MOVABLE = (217, 128, 52)
_OF_ROLE = {"keep_out": (196, 50, 50), "fence": (60, 120, 200)}
_OPACITY = 0.25
"""Opacity of a place that is not a body, so that things behind it stay visible."""
_WALL = 2.0
"""Edge of the part of a half-space's surface that is drawn [m]."""


class SceneObjects:
    """The objects in a Viser scene. To be used from Viser's event loop only.

    Objects that can be pushed are orange, fixed objects are brown; places to keep out
    of are red, fences blue, both transparent. A mesh whose file is
    not on the dashboard's machine is shown as its name.

    Args:
        server: The scene's server.

    Attributes:
        handles: The scene node of each object, by its name.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._shown: dict[str, SceneObject] = {}
        self.handles: dict[str, viser.SceneNodeHandle] = {}

    def show(self, objects: Sequence[SceneObject]) -> None:
        """Draw new objects, move objects that have moved, and remove the others."""
        with self._server.atomic():
            for name in self._shown.keys() - {thing.name for thing in objects}:
                self.handles.pop(name).remove()
                del self._shown[name]
            for thing in objects:
                shown = self._shown.get(thing.name)
                if shown is not None and _shape_of(shown) != _shape_of(thing):
                    self.handles.pop(thing.name).remove()
                    shown = None
                if not _looks_the_same(shown, thing):
                    self._place(thing)

    def _place(self, thing: SceneObject) -> None:
        position = [0.0 if value is None else value for value in thing.position]
        x, y, z, w = (0.0 if value is None else value for value in thing.orientation)
        handle = self.handles.get(thing.name)
        if handle is None:
            path = f"{_ROOT}/{thing.name}"
            colour = _colour_of(thing)
            handle = _draw(self._server.scene, path, thing, colour)
            if not thing.solid and hasattr(handle, "opacity"):
                handle.opacity = _OPACITY
            self.handles[thing.name] = handle
        handle.position = (position[0], position[1], position[2])
        handle.wxyz = (w, x, y, z)
        self._shown[thing.name] = thing


def _colour_of(thing: SceneObject) -> tuple[int, int, int]:
    if len(thing.colour) == 3:
        red, green, blue = thing.colour
        return red, green, blue
    return _OF_ROLE.get(thing.role) or (_MOVABLE if thing.mass > 0.0 else _FIXED)


def _shape_of(thing: SceneObject) -> object:
    """Return the shape of an object; an object whose shape changes is drawn anew."""
    return thing.type, thing.size, thing.file, thing.role, thing.colour


def _looks_the_same(shown: SceneObject | None, thing: SceneObject) -> bool:
    if shown is None:
        return False
    before = (*shown.position, *shown.orientation)
    now = (*thing.position, *thing.orientation)
    return all(
        abs((old or 0.0) - (new or 0.0)) < _SMALLEST_STEP
        for old, new in zip(before, now, strict=True)
    )


def _draw(
    scene: viser.SceneApi, path: str, thing: SceneObject, colour: tuple[int, int, int]
) -> viser.SceneNodeHandle:
    size = thing.size
    match thing.type:
        case "box" | "table":
            edges = (size[0], size[1], size[2])
            return scene.add_box(path, colour, edges, cast_shadow=False)
        case "half_space":
            plate = (_WALL, _WALL, 1e-3)
            return scene.add_box(path, colour, plate, cast_shadow=False)
        case "sphere":
            return scene.add_icosphere(path, size[0], colour, cast_shadow=False)
        case "cylinder":
            return scene.add_cylinder(path, size[0], size[1], colour, cast_shadow=False)
        case "capsule":
            mesh = trimesh.creation.capsule(height=size[1], radius=size[0])
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        case _:
            if not Path(thing.file).is_file():
                words = f"{thing.name} (its mesh is on another machine)"
                return scene.add_label(path, words)
            mesh = trimesh.load_mesh(thing.file)
    return scene.add_mesh_simple(
        path, mesh.vertices, mesh.faces, color=colour, cast_shadow=False
    )
