"""Load the collision meshes of a URDF into MuJoCo, in all supported file formats."""

from pathlib import Path

import mujoco

from station.core.description.urdf import Shape
from station.core.errors import RobotDescriptionError
from station.core.geometry.mesh_files import check_mesh_file

_BINARY_STL_HEADER = 84
_BINARY_STL_TRIANGLE = 50
_MAX_REASON = 200
_LEAST_CORNERS = 4


def add_mesh(spec: mujoco.MjSpec, name: str, shape: Shape) -> None:
    """Add a mesh asset; MuJoCo uses the convex hull of the mesh for collisions.

    MuJoCo reads binary STL and OBJ itself; other formats (Collada, ASCII STL) are read
    with trimesh and handed over as vertices and faces.

    Args:
        spec: The world; changed.
        name: Name of the new asset.
        shape: A shape of kind `mesh`.

    Raises:
        RobotDescriptionError: The file is missing, too large, has no triangles or is
            of an unknown format.
    """
    path = shape.mesh
    if path is None:
        raise RobotDescriptionError(
            f"The mesh '{name}' has no file.", remedy="Name a file in the URDF."
        )
    check_mesh_file(path)
    mesh = spec.add_mesh(name=name, scale=shape.size)
    mesh.info = str(path)  # for `compile_world`, if MuJoCo refuses the mesh
    # The link's inertia comes from the URDF; thin or open meshes are not an error.
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    is_obj = path.suffix.lower() == ".obj"
    if is_obj:
        _check_obj(path)
    if is_obj or _is_binary_stl(path):
        mesh.file = str(path)
        return
    vertices, faces = _load_with_trimesh(path)
    mesh.uservert = vertices
    mesh.userface = faces


def _check_obj(path: Path) -> None:
    """Refuse an OBJ file that is cut, which MuJoCo does not notice or cannot name.

    Raises:
        RobotDescriptionError: The mesh has no triangles, or one without its corners.
    """
    corners = faces = highest = 0
    with path.open("rb") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == b"v":
                corners += 1
            elif words[0] == b"f":
                faces += 1
                numbers = [word.partition(b"/")[0] for word in words[1:]]
                known = [int(n) for n in numbers if n.isdigit()]  # < 0 count backwards
                highest = max(highest, *known, 0)
    if not faces or corners < _LEAST_CORNERS:
        problem = f"has {corners} corners and {faces} triangles"
    elif highest > corners:
        problem = f"has a triangle with corner {highest}, and {corners} corners"
    else:
        return
    raise RobotDescriptionError(
        f"The mesh file {path} {problem}.",
        remedy="Use another file; this one is empty or cut.",
    )


def _is_binary_stl(path: Path) -> bool:
    if path.suffix.lower() != ".stl":
        return False
    with path.open("rb") as file:
        header = file.read(_BINARY_STL_HEADER)
    triangles = int.from_bytes(header[-4:], "little")
    size = _BINARY_STL_HEADER + _BINARY_STL_TRIANGLE * triangles
    return len(header) == _BINARY_STL_HEADER and path.stat().st_size == size


def _load_with_trimesh(path: Path) -> tuple[list[float], list[int]]:
    # Imported on demand: trimesh takes half a second, and most robots do not need it.
    import trimesh
    from collada import DaeError

    # What the readers of its formats raise for a file that is empty or cut.
    foreign = (ValueError, LookupError, OSError, TypeError, AttributeError, DaeError)
    try:
        mesh = trimesh.load_scene(path).to_mesh()
    except foreign as exc:
        reason = " ".join(str(exc).split())[:_MAX_REASON].removesuffix(".")
        raise RobotDescriptionError(
            f"The mesh file {path} cannot be read: {reason}.",
            remedy="Use another file, or convert this one to STL or OBJ.",
        ) from exc
    if len(mesh.faces) == 0:
        raise RobotDescriptionError(
            f"The mesh file {path} has no triangles.", remedy="Use another file."
        )
    return mesh.vertices.ravel().tolist(), mesh.faces.ravel().tolist()
