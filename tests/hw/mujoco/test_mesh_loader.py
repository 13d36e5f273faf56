"""Collision meshes of several formats."""

from pathlib import Path

import pytest

from station.core.description.urdf import Pose, Shape
from station.core.errors import RobotDescriptionError
from station.hw.mujoco.mesh_loader import add_mesh
from station.hw.mujoco.model_builder import new_world

# A tetrahedron.
ASCII_STL = """solid t
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 0 0 1
vertex 0 1 0
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 1
endloop
endfacet
facet normal 0 0 0
outer loop
vertex 1 0 0
vertex 0 1 0
vertex 0 0 1
endloop
endfacet
endsolid t
"""


def compile_with_mesh(path: Path, scale: float):
    spec = new_world(0.001, floor=False)
    add_mesh(spec, "m", Shape("mesh", Pose(), (scale, scale, scale), path))
    spec.worldbody.add_geom(type=7, meshname="m")
    return spec.compile()


@pytest.mark.slow  # The first use of trimesh takes more than a second.
def test_ascii_stl_is_read_and_scaled(tmp_path: Path) -> None:
    path = tmp_path / "t.stl"
    path.write_text(ASCII_STL, encoding="ascii")
    model = compile_with_mesh(path, 0.1)
    extent = model.mesh_vert.max(axis=0) - model.mesh_vert.min(axis=0)
    assert model.mesh_vertnum[0] == 4
    assert float(max(extent)) < 0.15


def test_unreadable_mesh_is_refused_with_its_path(tmp_path: Path) -> None:
    path = tmp_path / "t.stl"
    path.write_text("no mesh", encoding="ascii")
    with pytest.raises(RobotDescriptionError, match=r"t\.stl"):
        compile_with_mesh(path, 1.0)


def test_mesh_without_extension_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "hull"
    path.write_text(ASCII_STL, encoding="ascii")
    with pytest.raises(RobotDescriptionError, match="hull has no extension"):
        compile_with_mesh(path, 1.0)


def test_mesh_of_gigabytes_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.stl"
    with path.open("wb") as file:
        file.truncate(3_000_000_000)
    with pytest.raises(RobotDescriptionError, match="has 3000000000 bytes; a mesh may"):
        compile_with_mesh(path, 1.0)


def test_missing_mesh_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RobotDescriptionError, match=r"none\.stl cannot be read"):
        compile_with_mesh(tmp_path / "none.stl", 1.0)
