"""Reads the triangles of a mesh file, in metres and z up, or says why they cannot be had."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import trimesh

from backend.errors import InvalidInputError
from backend.pose import Array

FORMATS = (".obj", ".stl", ".ply", ".glb")
MOST_MB = 200
MOST_TRIANGLES = 200_000
SHORTEST_M, LONGEST_M = 0.01, 0.5
"""Range of an object's longest side."""
USUAL_M = (0.02, 0.4)
"""Where the longest side of what hands hold usually lies."""
UNITS = (
    (0.001, "millimetres"),
    (0.01, "centimetres"),
    (0.0254, "inches"),
    (1.0, "metres"),
    (1000.0, "metres, divided by 1000 once too often"),
)


def read_mesh(path: Path, scale: float) -> trimesh.Trimesh:
    """The file's triangles, ``scale`` metres per unit of the file, all of its parts in one, as they are.

    GLB is y up by its standard and is turned; the others are taken as z up. Raises ``InvalidInputError`` for a file
    that is missing, of another format, too large, broken, or without triangles, and for a size no hand can use.
    """
    _check_file(path)
    mesh = _parsed(path)
    if len(mesh.faces) == 0:
        raise InvalidInputError(f"{path} holds no triangles; an object needs a surface, not points or curves.")
    if len(mesh.faces) > MOST_TRIANGLES:
        raise InvalidInputError(
            f"{path} has {len(mesh.faces)} triangles, more than {MOST_TRIANGLES}. Simplify it first, "
            "for instance with Blender's Decimate or MeshLab's Quadric Edge Collapse."
        )
    if not np.isfinite(mesh.vertices).all():
        broken = int((~np.isfinite(mesh.vertices)).any(axis=1).sum())
        raise InvalidInputError(f"{path}: {broken} of its {len(mesh.vertices)} vertices are not finite numbers.")
    used = np.unique(mesh.faces)
    if used[0] < 0 or used[-1] >= len(mesh.vertices):
        raise InvalidInputError(f"{path} is broken: a triangle names a vertex that is not there.")
    check_size(path.name, np.ptp(mesh.vertices[used], axis=0), scale)
    vertices = mesh.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0) if path.suffix.lower() == ".glb" else mesh.vertices
    return trimesh.Trimesh(vertices * scale, mesh.faces, process=False)


def check_size(name: str, extents: Array, scale: float) -> None:
    """Raise ``InvalidInputError`` when ``extents`` (3,), in units of the file, are none of an object for a hand.

    The message names the scales that would make it one.
    """
    longest = float(extents.max())
    if SHORTEST_M <= longest * scale <= LONGEST_M:
        return
    low, high = USUAL_M
    fitting = [(unit_m, what) for unit_m, what in UNITS if unit_m != scale and low <= longest * unit_m <= high]
    guesses = [f"--scale {unit_m:g} if it is in {what} ({_length(longest * unit_m)})" for unit_m, what in fitting]
    advice = ", or ".join(guesses)
    if not guesses:
        between = f"{SHORTEST_M / longest:.3g} and {LONGEST_M / longest:.3g}" if longest > 0 else ""
        advice = f"a --scale between {between}" if between else "a mesh with a size"
    raise InvalidInputError(
        f"{name} would be {_length(longest * scale)} long with --scale {scale:g} (metres per unit of the file); "
        f"an object is {_length(SHORTEST_M)} to {_length(LONGEST_M)} long. What would work: {advice}."
    )


def _check_file(path: Path) -> None:
    if not path.is_file():
        raise InvalidInputError(f"There is no mesh file {path}.")
    if path.suffix.lower() not in FORMATS:
        kind = f"{path.suffix} files" if path.suffix else "files without an ending"
        raise InvalidInputError(f"{path}: {kind} are not read. Export it as one of: {', '.join(FORMATS)}.")
    size_mb = path.stat().st_size / 1e6
    if size_mb > MOST_MB:
        raise InvalidInputError(f"{path} has {size_mb:.0f} MB, more than {MOST_MB}. Simplify the mesh first.")
    if size_mb == 0.0:
        raise InvalidInputError(f"{path} is empty.")


def _parsed(path: Path) -> trimesh.Trimesh:
    """All triangles of the file, its scene's transforms applied; materials and files it refers to are left alone."""
    try:
        with path.open("rb") as file, np.errstate(all="ignore"):
            loaded: Any = cast(Any, trimesh).load_scene(
                file, file_type=path.suffix.lower()[1:], process=False, skip_materials=True
            )
            return loaded.to_mesh()
    except OSError as error:
        raise InvalidInputError(f"{path} cannot be read ({error.strerror or error}).") from error
    except Exception as error:  # whatever a parser of foreign files stumbles over
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InvalidInputError(f"{path} is not a {path.suffix.lower()} mesh that can be read ({reason}).") from error


def _length(metres: float) -> str:
    """A length in the unit people would use."""
    if metres >= 1.0:
        return f"{metres:.3g} m"
    return f"{100 * metres:.3g} cm" if metres >= 0.01 else f"{1000 * metres:.3g} mm"
