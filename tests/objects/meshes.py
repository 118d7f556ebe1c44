"""Mesh files for tests, as users might bring them."""

from pathlib import Path
from typing import Any, cast

import numpy as np
import trimesh

_create = cast(Any, trimesh.creation)


def box(*sides: float) -> trimesh.Trimesh:
    """Around the origin."""
    return _create.box(sides)


def mug() -> trimesh.Trimesh:
    """In millimetres: an open cup 80 wide and 90 high, its walls 3.5 to 5 thick."""
    profile = np.array([[0, 0], [38, 0], [40, 2], [40, 90], [36.5, 90], [36.5, 6], [0, 5]], dtype=np.float64)
    return _create.revolve(profile, sections=32)


def torus() -> trimesh.Trimesh:
    """In metres, 84 mm wide and 24 mm high, its volume known: 2 pi^2 R r^2."""
    return _create.torus(0.030, 0.012, major_sections=48, minor_sections=32)


def ball() -> trimesh.Trimesh:
    """70 mm wide."""
    return _create.icosphere(subdivisions=2, radius=0.035)


def apart(*meshes: trimesh.Trimesh) -> trimesh.Trimesh:
    """Side by side."""
    moved = [trimesh.Trimesh(m.vertices + np.array([0.3 * i, 0, 0]), m.faces) for i, m in enumerate(meshes)]
    return cast(Any, trimesh.util).concatenate(moved)


def lidless(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Without what faces straight up."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces[mesh.face_normals[:, 2] < 0.9])


def torn(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """With a wing: a third triangle on one edge, which no filling of holes mends."""
    a, b = mesh.faces[0][:2]
    return trimesh.Trimesh(
        np.vstack([mesh.vertices, [[1.2, 1.1, 1.3]] * mesh.vertices.max(axis=0)]),
        np.vstack([mesh.faces, [[a, b, len(mesh.vertices)]]]),
        process=False,
    )


def inside_out(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Its faces turned inwards."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def written(mesh: trimesh.Trimesh, path: Path) -> Path:
    """As a file of the kind its ending says."""
    mesh.export(str(path))
    return path
