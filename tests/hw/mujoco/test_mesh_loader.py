"""Collision meshes of several formats."""

from pathlib import Path

import pytest
import trimesh

from station.core.description.urdf import Pose, Shape
from station.core.errors import RobotDescriptionError
from station.hw.mujoco.model_builder import add_mesh, new_world
from tests.hw.mujoco.test_description_repair import make

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


LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a21\nsize 12345\n"


def make_robot_with_mesh(folder: Path, suffix: str, content: bytes) -> None:
    """Simulate a robot whose root link has a mesh with some content."""
    mesh = folder / f"hull.{suffix}"
    mesh.write_bytes(content)
    make(
        folder / "r.urdf",
        '<robot name="r"><link name="base"><collision><geometry>'
        f'<mesh filename="{mesh}"/></geometry></collision></link></robot>',
    )


@pytest.mark.slow  # Each format has a reader of its own.
@pytest.mark.parametrize("suffix", ["stl", "obj", "dae", "ply", "glb"])
def test_mesh_that_is_empty_or_cut_is_refused_by_link_and_file(
    tmp_path: Path, suffix
) -> None:
    whole = trimesh.creation.box((0.1, 0.1, 0.1)).export(file_type=suffix)
    whole = whole if isinstance(whole, bytes) else whole.encode()
    third, half = whole[: len(whole) // 3], whole[: len(whole) // 2]
    for content in (b"", LFS, third, half, bytes(range(256))):
        named = rf"link 'base' <collision>: .*hull\.{suffix}"
        with pytest.raises(RobotDescriptionError, match=named):
            make_robot_with_mesh(tmp_path, suffix, content)
    make_robot_with_mesh(tmp_path, suffix, whole)


def test_checkout_without_its_large_files_is_named(tmp_path: Path) -> None:
    with pytest.raises(RobotDescriptionError, match="placeholder") as refused:
        make_robot_with_mesh(tmp_path, "obj", LFS)
    assert "git lfs pull" in refused.value.remedy


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n", "coplanar"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 3 5\n", "corner 5"),
    ],
)
def test_mesh_that_cannot_collide_is_refused_by_link_and_file(
    tmp_path: Path, mesh, reason
) -> None:
    named = rf"link 'base' <collision>: .*hull\.obj.*{reason}"
    with pytest.raises(RobotDescriptionError, match=named):
        make_robot_with_mesh(tmp_path, "obj", mesh)
