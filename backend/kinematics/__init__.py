"""Compiled kinematics: where links, tcp and collision spheres are, and which joints put the tcp where."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from backend.kinematics.kinematics import Kinematics, load_kinematics

__all__ = ["Kinematics", "load_kinematics"]


def __getattr__(name: str) -> Any:
    """Import the compiler only for those who compute, so that drawing from a ``LinkTree`` stays light."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from backend.kinematics import kinematics

    return getattr(kinematics, name)
