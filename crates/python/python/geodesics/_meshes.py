"""Arrays of meshes of other packages."""

from __future__ import annotations

from typing import Any

import numpy as np


def arrays_of(mesh: Any, faces: Any) -> tuple[Any, Any]:
    """Positions and faces: an (m, 3) array, or a list of the corners of each polygon."""
    if faces is None:
        mesh, faces = _taken_apart(mesh)
    elif not isinstance(faces, np.ndarray) and hasattr(faces, "__len__") and len(faces) > 0:
        try:
            sizes = {len(corners) for corners in faces}
        except TypeError:
            sizes = {3}
        if sizes != {3}:
            return mesh, [np.asarray(corners).tolist() for corners in faces]
    if getattr(faces, "ndim", None) == 2 and faces.shape[1] > 3 and faces.dtype.kind in "iu":
        faces = faces.tolist()
    return mesh, faces


def _taken_apart(mesh: Any) -> tuple[Any, Any]:
    # meshio: blocks of cells of one kind. Grids of PyVista have `cells_dict` as well.
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict") and not hasattr(mesh, "n_cells"):
        faces: list[Any] = []
        for block in mesh.cells:
            # The nodes of curved cells, such as triangle6, follow their corners.
            corners = {"triangle": 3, "quad": 4, "polygon": None}
            kind = block.type.rstrip("0123456789")
            if kind in corners:
                faces.extend(np.asarray(block.data)[:, : corners[kind]].tolist())
        if not faces:
            raise ValueError("vertices: this mesh of meshio has neither triangles nor polygons")
        return mesh.points, _even(faces)
    # PyVista: polygons one after the other, each after its number of corners.
    if hasattr(mesh, "points") and hasattr(mesh, "n_cells"):
        if hasattr(mesh, "celltypes") and np.isin(mesh.celltypes, (5, 7, 9)).all():
            # Triangles, polygons and quads; the vertices keep their numbers.
            rest = np.asarray(mesh.cells)
        else:
            if not hasattr(mesh, "faces"):
                mesh = mesh.extract_surface()
            rest = np.asarray(mesh.faces)
        if len(rest) % 4 == 0 and (rest[::4] == 3).all():
            return mesh.points, rest.reshape(-1, 4)[:, 1:]
        faces = []
        place = 0
        while place < len(rest):
            end = place + 1 + int(rest[place])
            faces.append(rest[place + 1 : end].tolist())
            place = end
        return mesh.points, _even(faces)
    # trimesh, and others like it.
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return np.asarray(mesh.vertices), np.asarray(mesh.faces)
    raise TypeError(
        "faces: missing; give the corners of the faces, or a mesh of PyVista, trimesh or meshio alone"
    )


def _even(faces: list[Any]) -> Any:
    """An array if all are triangles."""
    if all(len(corners) == 3 for corners in faces):
        return np.array(faces, dtype=np.int64).reshape(-1, 3)
    return faces
