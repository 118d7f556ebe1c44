"""Objects made of meshes in tests."""

from pathlib import Path
from typing import Any

import trimesh

from backend.build.own_object import Made, Wanted, make_own
from tests.objects import meshes


def silent(_: str) -> None:
    """No progress is told."""


def made_of(mesh: trimesh.Trimesh, folder: Path, ending: str = "stl", **wishes: Any) -> Made:
    path = meshes.written(mesh, folder / f"thing.{ending}")
    return make_own(path, wanted(**wishes), silent)


def wanted(**wishes: Any) -> Wanted:
    defaults: dict[str, Any] = {"name": "thing", "mass_kg": 0.2}
    return Wanted(**(defaults | wishes))
