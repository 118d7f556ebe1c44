"""Physics: what is really happening, and the planner's belief of it."""
