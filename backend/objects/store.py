"""Finished objects as files: those that come with the project are made once per user, then read in milliseconds."""

from __future__ import annotations

import hashlib
import json
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.files import cache_folder, replacing
from backend.objects.description import MakeObject, ObjectDescription
from backend.objects.mesh import Mesh


def stored(name: str, make: MakeObject) -> ObjectDescription:
    """The object as it was stored, else made now and stored."""
    path = cache_folder() / "objects" / f"{name}-{_sources()}.npz"
    found = read_object(path)
    if found is None:
        found = make()
        write_object(path, found)
    return found


def read_object(path: Path) -> ObjectDescription | None:
    """None when there is no such file, or none that can be read."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            facts = json.loads(str(arrays["facts"]))
            meshes = [Mesh(arrays[f"vertices{k}"], arrays[f"faces{k}"]) for k in range(facts.pop("meshes"))]
        facts["color_rgb"] = tuple(facts["color_rgb"])
        return ObjectDescription(visual=meshes[0], convex_parts=tuple(meshes[1:]), **facts)
    except (OSError, EOFError, IndexError, KeyError, TypeError, ValueError, zipfile.BadZipFile):
        return None


def write_object(path: Path, made: ObjectDescription) -> None:
    """All of the object in one file, or nothing; raises ``OSError`` when the folder cannot be written."""
    meshes = (made.visual, *made.convex_parts)
    facts = {
        "name": made.name,
        "title": made.title,
        "mass_kg": made.mass_kg,
        "color_rgb": made.color_rgb,
        "lateral_friction": made.lateral_friction,
        "spinning_friction": made.spinning_friction,
        "source": made.source,
        "meshes": len(meshes),
    }
    arrays: dict[str, NDArray[Any]] = {f"vertices{k}": mesh.vertices for k, mesh in enumerate(meshes)}
    arrays |= {f"faces{k}": mesh.faces for k, mesh in enumerate(meshes)}
    with replacing(path) as file:
        np.savez(file, allow_pickle=False, facts=np.array(json.dumps(facts)), **arrays)


@cache
def _sources() -> str:
    """A hash of this room's code, which decides what its objects look like."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
