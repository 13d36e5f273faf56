"""Colours of faces become those of vertices, without SciPy."""

import numpy as np
import trimesh

from station.ui.scene.robot_scene import color_by_vertices

RED, BLUE = (255, 0, 0, 255), (0, 0, 255, 255)


def two_triangles() -> trimesh.Trimesh:
    """Return two triangles that share an edge, and a vertex without a face."""
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (9, 9, 9)]
    faces = [(0, 1, 2), (1, 3, 2)]
    return trimesh.Trimesh(vertices, faces, process=False)


def test_vertex_has_the_mean_colour_of_its_faces():
    mesh = two_triangles()
    mesh.visual = trimesh.visual.ColorVisuals(mesh, face_colors=[RED, BLUE])

    color_by_vertices(mesh)

    both = (128, 0, 128, 255)
    expected = [RED, both, both, BLUE]
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:4], expected)
    assert len(mesh.export(file_type="glb")) > 0


def test_other_colours_stay():
    mesh = two_triangles()
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=[RED] * 5)
    before = mesh.visual

    color_by_vertices(mesh)

    assert mesh.visual is before
