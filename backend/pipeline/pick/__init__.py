"""pick: Shortlist -> the grasp to move to."""

from backend.pipeline.pick.goals import goals_at_once
from backend.pipeline.pick.nearest import pick_nearest

__all__ = ["goals_at_once", "pick_nearest"]
