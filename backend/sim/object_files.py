"""Objects as mesh files for PyBullet: one OBJ per object, named by its contents, a group per convex part."""

import hashlib
import os
import tempfile
from pathlib import Path

from backend.objects.description import ObjectDescription
from backend.robots.models import cache_folder


def object_mesh_file(description: ObjectDescription) -> Path:
    """Path of the object's convex parts, written if need be. PyBullet reads each group as a convex hull."""
    text = _obj_text(description)
    path = cache_folder() / "objects" / f"{description.name}-{hashlib.sha256(text.encode()).hexdigest()[:16]}.obj"
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(prefix=f".{description.name}-", dir=path.parent)
        with os.fdopen(handle, "w") as file:
            file.write(text)
        os.replace(aside, path)
    return path


def _obj_text(description: ObjectDescription) -> str:
    lines: list[str] = []
    first = 1
    for i, part in enumerate(description.convex_parts):
        lines.append(f"o part_{i}")
        lines += [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in part.vertices.tolist()]
        lines += [f"f {a + first} {b + first} {c + first}" for a, b, c in part.faces.tolist()]
        first += len(part.vertices)
    return "\n".join(lines) + "\n"
