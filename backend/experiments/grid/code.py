"""Which code and which knowledge a row was made with."""

import hashlib
from functools import cache
from pathlib import Path

import backend
from backend.knowledge.shelf import MANIFEST

ROOT = Path(backend.__file__).parent


@cache
def code_version() -> str:
    """The project's version and 8 hexadecimal digits that differ when the engine's source or assets do."""
    digest = hashlib.sha256()
    for path in [*sorted(ROOT.rglob("*.py")), MANIFEST]:
        digest.update(path.relative_to(ROOT).as_posix().encode() + path.read_bytes())
    return f"{backend.__version__}+{digest.hexdigest()[:8]}"
