"""pick: Shortlist -> the grasp to move to."""

from backend.pipeline.pick.nearest import pick_nearest

__all__ = ["pick_nearest"]
