"""The compiler of every numeric kernel, and where compiled code is kept between runs."""

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config

F = TypeVar("F", bound=Callable[..., Any])

LOOP_FOLDERS = ("kinematics", "knowledge", "pipeline/plan", "pipeline/retime", "sim")
"""Where the kernels of a trial are."""
BUILD_FOLDERS = (*LOOP_FOLDERS, "build")
"""Where those are that offline work calls."""


def kernel(function: F) -> F:
    """Compile ``function`` at its first call and keep the machine code on disk."""
    folders = BUILD_FOLDERS if function.__module__.startswith("backend.build") else LOOP_FOLDERS
    setattr(config, "CACHE_DIR", os.environ.get("NUMBA_CACHE_DIR") or cache_folder(folders))  # noqa: B010
    return cast(F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))


@cache
def cache_folder(folders: tuple[str, ...]) -> str:
    """A folder per state of the sources in these folders of the backend.

    Numba only notices a change in the file of the outermost kernel; a kernel that calls another
    file's would go on using its old machine code.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    backend = Path(__file__).resolve().parents[1]
    for folder in folders:
        for source in sorted((backend / folder).glob("*.py")):
            text = source.read_bytes()
            digest.update(text if b"@kernel" in text else b"")
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return str(home / "dynamic-grasping" / "kernels" / digest.hexdigest()[:16])
