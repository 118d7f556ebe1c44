"""Motion: every way the belt's tray can go, as closed formulas of time."""

from typing import Annotated

from pydantic import Field

from backend.motions.circular import CircularMotion
from backend.motions.linear import LinearMotion
from backend.motions.sinusoidal import SinusoidalMotion

Motion = Annotated[LinearMotion | CircularMotion | SinusoidalMotion, Field(discriminator="kind")]
"""All have ``pose_at``, ``xyz_at``, ``velocity_at`` (of ``t_s``), ``path_world(n)``, ``duration_s`` and ``yaw_rad``."""

__all__ = ["CircularMotion", "LinearMotion", "Motion", "SinusoidalMotion"]
