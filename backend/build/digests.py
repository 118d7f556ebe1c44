"""Digests of what decides a result: code, hand, object; the same on every machine.

Whoever finds the same one need not compute again.
"""

import ast
import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

from backend.methods.method import Execution
from backend.objects import load_object
from backend.robots.models import load_model

BACKEND = Path(__file__).parents[1]
PHYSICS = (
    *("build/rig.py", "sim/bullet.py", "sim/hand.py", "sim/gripper.py"),
    *("pipeline/execute/blend.py", "pipeline/execute/closing.py"),
)
"""The code that decides how an attempt on the rig ends."""


def rig_digest(robot: str, object: str) -> str:
    """Equal when attempts on the rig end equally: the shapes of hand and object, friction, mass, code, execution."""
    digest = hashlib.sha256(urdf_digest(load_model(robot).hand_urdf).encode())
    target = load_object(object)
    digest.update(repr((target.mass_kg, target.lateral_friction, target.spinning_friction)).encode())
    for part in target.convex_parts:
        digest.update(part.vertices.tobytes())
    digest.update(code_digest(PHYSICS).encode())
    digest.update(repr(Execution()).encode())
    return digest.hexdigest()


def urdf_digest(urdf: Path) -> str:
    """Of a URDF and the meshes that it names."""
    named = sorted(set(re.findall(r'filename="([^"]+)"', urdf.read_text())))
    return files_digest([urdf, *(urdf.parent / name for name in named)])


def files_digest(paths: Iterable[Path]) -> str:
    """Of the contents of files, in this order."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def code_digest(patterns: Iterable[str]) -> str:
    """Of the backend's files of these patterns; comments, docstrings and layout do not count."""
    return digest_of(path for pattern in patterns for path in BACKEND.glob(pattern))


def digest_of(paths: Iterable[Path]) -> str:
    """Equal for equal code under equal file names."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        tree = ast.parse(path.read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                node.body = [line for line in node.body if not _is_text(line)] or [ast.Pass()]
        digest.update(f"{path.name} {ast.dump(tree)}\n".encode())
    return digest.hexdigest()


def _is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)
