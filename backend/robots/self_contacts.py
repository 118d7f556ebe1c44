"""Which pairs of links are checked for self-collision: all but neighbours, pairs of the hand, and the allowed ones."""

from __future__ import annotations

from itertools import combinations

from backend.robots.models import RobotModel


def checked_pairs(model: RobotModel) -> list[tuple[str, str]]:
    """Pairs of links with geometry that may collide with each other."""
    robot = model.description
    hand = frozenset(robot.gripper.hand_links)
    return [
        (a, b)
        for a, b in combinations(model.spheres, 2)
        if frozenset((a, b)) not in robot.allowed_self_contacts and not {a, b} <= hand
    ]
