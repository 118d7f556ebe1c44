"""Draggable: a body that can be pushed about on the floor with the mouse."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from backend.pose import Array

LOWEST_SLOPE = 0.05
"""A look flatter than this along the floor says nothing about where on it."""


def on_floor(camera_m: Array, pointer_m: Array, height_m: float) -> Array | None:
    """(2,) where the line of sight from the camera through the pointer meets the given height; None if it doesn't."""
    ray = pointer_m - camera_m
    length = float(np.linalg.norm(ray))
    if length == 0.0 or abs(ray[2]) < LOWEST_SLOPE * length:
        return None
    share = (height_m - camera_m[2]) / ray[2]
    return (camera_m + share * ray)[:2] if share > 0.0 else None


def make_draggable(
    node: viser.MeshHandle,
    may: Callable[[viser.ClientHandle], bool],
    hold: Callable[[bool], None],
    dropped: Callable[[Array, viser.ClientHandle], None],
) -> None:
    """Let the node follow the pointer at the height it was grabbed; ``dropped`` is told (2,) where it was left.

    A browser that ``may`` not moves nothing.
    """

    async def on_drag(event: viser.SceneNodeDragEvent[Any]) -> None:
        if not may(event.client):
            hold(False)
            return
        hold(event.phase != "end")
        grabbed = np.array(event.start_position)
        there = on_floor(event.client.camera.position, np.array(event.end_position), float(grabbed[2]))
        if there is not None:
            moved = there - grabbed[:2]
            node.position = node.position + np.array([*moved, 0.0])
        if event.phase == "end":
            dropped(node.position[:2].copy(), event.client)

    node.on_drag("left")(on_drag)
