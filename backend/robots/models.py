"""A robot's geometry, made once per user and machine from its sources, then loaded in milliseconds."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from backend.errors import lookup
from backend.files import cache_folder
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.robots.description import RobotDescription
from backend.robots.sources import SOURCES, RobotSource, packages_root, source_files

MAKERS = ("collada", "description", "making", "meshes", "shapes", "sources", "spheres")
"""The files of this room whose text decides what a model looks like."""


@dataclass(frozen=True, eq=False)
class RobotModel:
    """Files and arrays made from a description. The paths are unique to their contents."""

    description: RobotDescription
    collision_urdf: Path
    """Convex hulls and boxes only; for physics."""
    visual_urdf: Path
    """Coloured meshes only (PLY); for the page. Mesh paths are relative to the URDF."""
    hand_urdf: Path
    """The hand alone, collision only; its root link is a free body with mass."""
    T_handroot_tcp: Pose
    spheres: dict[str, Array]
    """Link name -> (n, 4) x, y, z, radius in the link frame, metres; they cover the link's surface."""


def load_model(name: str) -> RobotModel:
    """The model of a robot, made now if it is missing or its sources have changed.

    Raises ``NotFoundError`` for an unknown name, ``MissingResourceError`` when ``rtb-data`` is missing.
    """
    description = lookup("robot", name, ROBOTS)
    source = lookup("robot source", name, SOURCES)
    root = packages_root()
    folder = cache_folder() / f"{name}-{_fingerprint(description, source, root)}"
    if not folder.is_dir():
        _make(description, source, root, folder)
    facts = json.loads((folder / "model.json").read_text())
    with np.load(folder / "spheres.npz") as arrays:
        spheres = {link: np.asarray(arrays[link], dtype=np.float64) for link in arrays.files}
    return RobotModel(
        description=description,
        collision_urdf=folder / "collision.urdf",
        visual_urdf=folder / "visual.urdf",
        hand_urdf=folder / "hand.urdf",
        T_handroot_tcp=Pose(np.array(facts["T_handroot_tcp"])),
        spheres=spheres,
    )


def _make(description: RobotDescription, source: RobotSource, root: Path, folder: Path) -> None:
    """Make the model aside, then move it into place in one step; other processes wait for the first one."""
    from backend.robots.making import make_model

    folder.parent.mkdir(parents=True, exist_ok=True)
    with open(folder.parent / f".{description.name}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if folder.is_dir():
            return
        aside = Path(tempfile.mkdtemp(prefix=f".{description.name}-", dir=folder.parent))
        try:
            make_model(description, source, root, aside)
            aside.chmod(0o755)
            os.rename(aside, folder)
        finally:
            shutil.rmtree(aside, ignore_errors=True)


def _fingerprint(description: RobotDescription, source: RobotSource, root: Path) -> str:
    """Hash over what a model is made from: source files (path, size, time), description, the makers' code."""
    digest = hashlib.sha256()
    for path in source_files(source, root):
        stat = path.stat()
        digest.update(f"{path} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    for maker in MAKERS:
        digest.update(Path(__file__).with_name(f"{maker}.py").read_bytes())
    digest.update(repr((description.gripper.hand_links, description.flange_link, source)).encode())
    digest.update(description.T_flange_tcp.matrix.tobytes())
    return digest.hexdigest()[:16]
