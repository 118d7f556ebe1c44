"""Objects as mesh files for PyBullet: one OBJ per object, named by its contents, a group per convex part."""

import hashlib
from pathlib import Path

from backend.files import cache_folder, replacing
from backend.objects import ObjectDescription


def object_mesh_file(description: ObjectDescription) -> Path:
    """Path of the object's convex parts, written if need be. PyBullet reads each group as a convex hull."""
    text = _obj_text(description)
    path = cache_folder() / "objects" / f"{description.name}-{hashlib.sha256(text.encode()).hexdigest()[:16]}.obj"
    if not path.is_file():
        with replacing(path) as file:
            file.write(text.encode())
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
