"""REPORTS: what can be measured of what the robot knows; each has ``tables(options)`` and ``show(tables)``."""

REPORTS = ("grasps", "reachability", "motion-aware", "prediction")
"""In the order of section IV of the paper; ``knowledge`` is all of them."""
