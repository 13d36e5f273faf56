"""Colours of a mesh by its vertices, as a browser draws them."""

import numpy as np
import trimesh


def color_by_vertices(mesh: trimesh.Trimesh) -> None:
    """Replace colours of the faces by colours of the vertices.

    trimesh does the same when it copies or writes a mesh, but with SciPy: 113 MB for a
    mean.

    Args:
        mesh: Changed when its faces have colours; a vertex gets the mean colour of the
            faces around it, and opaque grey without any.
    """
    visual = mesh.visual
    if not isinstance(visual, trimesh.visual.ColorVisuals) or visual.kind != "face":
        return
    sums = np.zeros((len(mesh.vertices), 4))
    counts = np.zeros((len(mesh.vertices), 1))
    for corner in mesh.faces.T:  # (faces,)
        np.add.at(sums, corner, visual.face_colors)
        np.add.at(counts, corner, 1.0)
    grey = trimesh.visual.color.DEFAULT_COLOR
    colors = np.where(counts > 0.0, sums / np.maximum(counts, 1.0), grey)
    colors = colors.round().astype(np.uint8)
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=colors)
