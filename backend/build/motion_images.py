"""What an attempt says beside itself: as if the object had been believed elsewhere, and as its symmetries show it.

An attempt is known with where the object truly was. The same grasp in the world, seen from any other place where the
object might have been believed to be, would have ended the same; and so would its images under the object's
symmetries. Every epoch learns from another image of every attempt.
"""

from __future__ import annotations

import numpy as np

from backend.build.attempts import Attempts
from backend.build.motion_data import AttemptSettings, draw_misplaced
from backend.build.symmetries import Symmetries
from backend.pose import Array

Shown = tuple[Array, Array]
"""Grasps (n, 4, 4) in the believed object's frame, and directions of motion (n,) rad."""


def images(
    attempts: Attempts, alike: Symmetries, settings: AttemptSettings, share: float, rng: np.random.Generator
) -> Shown:
    """One image of every attempt, of which a ``share`` are believed anew."""
    shown = attempts.Ts_object_grasp, attempts.direction_rad
    anew = rng.random(len(attempts)) < share
    elsewhere = believed_at(attempts, draw_misplaced(settings, rng, len(attempts)))
    Ts = np.where(anew[:, None, None], elsewhere[0], shown[0])
    directions = np.where(anew, elsewhere[1], shown[1])
    return alike.images(Ts, directions, rng.integers(len(alike), size=len(attempts)))


def believed_at(attempts: Attempts, misplaced: Array) -> Shown:
    """The attempts as they would be with the true object at ``misplaced`` (n, 3) in the frame of the believed one."""
    Ts_true = np.linalg.inv(_planar(attempts.misplaced)) @ attempts.Ts_object_grasp
    turned_rad = misplaced[:, 2] - attempts.misplaced[:, 2]
    return _planar(misplaced) @ Ts_true, attempts.direction_rad + turned_rad


def _planar(x_y_yaw: Array) -> Array:
    """(n, 4, 4) of (n, 3) metres and radians."""
    Ts = np.tile(np.eye(4), (len(x_y_yaw), 1, 1))
    cos, sin = np.cos(x_y_yaw[:, 2]), np.sin(x_y_yaw[:, 2])
    Ts[:, 0, 0], Ts[:, 0, 1], Ts[:, 1, 0], Ts[:, 1, 1] = cos, -sin, sin, cos
    Ts[:, :2, 3] = x_y_yaw[:, :2]
    return Ts
