"""Makes one closed body of a mesh as files hold it: joined, its holes closed, its faces turned outwards."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from backend.errors import InvalidInputError
from backend.objects.loft import convex_hull
from backend.objects.mesh import Mesh

LEAST_M3 = 1e-9
"""A body of less than a cubic millimetre is none."""


def closed_body(raw: trimesh.Trimesh, name: str) -> tuple[Mesh, tuple[str, ...]]:
    """The body, and what had to be repaired, in words.

    Raises ``InvalidInputError`` when there are several bodies, when holes remain, or when nothing is enclosed.
    """
    mesh = _joined(raw)
    _check_single(mesh, name)
    repairs: list[str] = []
    if not mesh.is_watertight:
        edges = _open_edges(mesh)
        trimesh.repair.fill_holes(mesh, use_fan=True)
        if not mesh.is_watertight:
            raise InvalidInputError(
                f"{name} is not closed: {edges} of its edges do not join exactly two triangles, and its holes "
                "could not be closed. Close them (Blender: 3D-Print Toolbox, Make Manifold; MeshLab: Close Holes)."
            )
        repairs.append(f"closed its holes ({edges} open edges)")
    if not mesh.is_winding_consistent or mesh.volume < 0:
        trimesh.repair.fix_normals(mesh)
        repairs.append("turned its faces outwards")
    body = Mesh(np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int64))
    _check_solid(body, name)
    return body, tuple(repairs)


def _joined(raw: trimesh.Trimesh) -> trimesh.Trimesh:
    """The same surface, each corner and each triangle once, without triangles that have no area for want of corners."""
    mesh = trimesh.Trimesh(raw.vertices, raw.faces, process=False)
    mesh.merge_vertices()
    corners: NDArray[np.int64] = np.sort(mesh.faces, axis=1)
    _, first = np.unique(corners, axis=0, return_index=True)
    kept = np.zeros(len(corners), dtype=np.bool_)
    kept[first] = True
    kept &= (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])
    mesh.update_faces(kept)
    mesh.remove_unreferenced_vertices()
    return mesh


def _check_single(mesh: trimesh.Trimesh, name: str) -> None:
    bodies: Any = cast(Any, trimesh.graph).connected_components(
        mesh.edges_unique, nodes=np.arange(len(mesh.vertices)), engine="scipy"
    )
    if len(bodies) == 1:
        return
    sides = sorted((float(np.ptp(mesh.vertices[body], axis=0).max()) for body in bodies), reverse=True)
    longest = ", ".join(f"{100 * side:.2g} cm" for side in sides[:3])
    raise InvalidInputError(
        f"{name} holds {len(bodies)} separate bodies (longest sides: {longest}{', ...' if len(sides) > 3 else ''}); "
        "an object is one. Join them (Blender: Boolean, Union), merge torn seams (Merge by Distance), or export one."
    )


def _check_solid(body: Mesh, name: str) -> None:
    """A body's volume is above nothing and within its convex hull, and so is its centre of mass."""
    if body.volume_m3 < LEAST_M3 or np.ptp(body.vertices, axis=0).min() < 1e-4:
        raise InvalidInputError(f"{name} encloses no volume: it is flat, or its faces cancel out.")
    hull = convex_hull(body.vertices)
    heights = ((body.center_of_mass_m - hull.triangles[:, 0]) * hull.face_normals).sum(axis=1)
    if body.volume_m3 > 1.001 * hull.volume_m3 or heights.max() >= 0.0:
        raise InvalidInputError(f"{name} winds around itself: its surface must not pass through itself. Remesh it.")


def _open_edges(mesh: trimesh.Trimesh) -> int:
    """How many edges do not belong to exactly two triangles."""
    _, uses = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    return int((uses != 2).sum())
