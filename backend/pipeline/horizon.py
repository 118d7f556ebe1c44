"""How far ahead of the end of thinking the object's pose is predicted."""

from dataclasses import dataclass

from backend.methods.method import HorizonConfig, Intercept


@dataclass(frozen=True)
class Underway:
    """A grasp the arm is moving to."""

    hand_to_pregrasp_m: float
    """From where the hand will be when thinking ends."""
    left_s: float
    """Of the motion in force, when thinking ends."""


def horizon_s(config: HorizonConfig, underway: Underway | None) -> float:
    """Seconds; ``underway`` is None before a grasp is chosen."""
    if isinstance(config, Intercept):
        return config.first_s if underway is None else min(max(underway.left_s, 0.0), config.longest_s)
    if underway is None or underway.hand_to_pregrasp_m > config.far_m:
        return config.far_s
    return config.middle_s if underway.hand_to_pregrasp_m > config.near_m else config.near_s
