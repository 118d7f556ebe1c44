"""Ways through space: the predicted object's, the plan's and its seed's, and where the hand has been."""

from __future__ import annotations

from collections import deque

import numpy as np
import viser

from app.history import KEPT_S
from app.ui import palette
from app.ui.geometry import segments
from app.ui.layers.bodies import add_object
from app.ui.layers.layer import Picture, Root, place
from app.ui.palette import Rgb
from app.ui.touch import Touch
from backend.objects import load_object
from backend.pipeline.values import Prediction
from backend.pose import Array
from backend.snapshot import SceneDescription

NOWHERE = np.zeros((1, 2, 3))
SEED_BELOW_M = np.array([0.0, 0.0, 0.004])
"""The seed is drawn a little lower, so that a plan that follows it is seen on top of it."""
THINNEST_M = 1e-3
"""Bounds nearer to the way than this are not drawn."""
TRAIL_S = 8.0
TRAIL_STEP_S = 0.1
TRAIL_REDRAW_S = 0.2


class Polyline:
    """A line that is redrawn by handing it points; None hides it."""

    def __init__(self, scene: viser.SceneApi, name: str, color: Rgb, thickness_px: float) -> None:
        self._node = scene.add_line_segments(
            name, NOWHERE, color, thickness=thickness_px, thickness_units="screen", visible=False
        )

    def draw(self, points_m: Array | None) -> None:
        """(n, 3) points in the world."""
        if points_m is None or len(points_m) == 0:
            self._node.visible = False
            return
        self._node.points = segments(points_m).astype(np.float32)
        self._node.visible = True


class PredictionLayer:
    """A ghost of the object where it is predicted to be grasped, the way it is predicted to take, and how surely."""

    title = "Prediction"
    swatches: tuple[tuple[Rgb, str], ...] = (
        (palette.PREDICTION, "Predicted object"),
        (palette.PREDICTION_BOUNDS, "Within 2 sigma"),
    )

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/prediction")
        self._ghost: viser.MeshHandle | None = None
        self._way: Polyline | None = None
        self._bounds: Polyline | None = None

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        shape = load_object(scene.object)
        self._ghost = add_object(self._scene, f"{self._root.name}/ghost", shape, palette.PREDICTION, opacity=0.3)
        self._ghost.visible = False
        self._way = Polyline(self._scene, f"{self._root.name}/way", palette.PREDICTION, 4.0)
        self._bounds = Polyline(self._scene, f"{self._root.name}/bounds", palette.PREDICTION_BOUNDS, 2.0)

    def draw(self, picture: Picture) -> None:
        cycle = picture.cycle
        if not picture.new_cycle or self._ghost is None or self._way is None or self._bounds is None:
            return
        prediction, shortlist = (cycle.prediction, cycle.shortlist) if cycle else (None, None)
        self._way.draw(None if prediction is None else prediction.Ts_world_object[:, :3, 3])
        self._bounds.draw(None if prediction is None else two_sigma_m(prediction))
        self._ghost.visible = shortlist is not None
        if shortlist is not None:
            place(self._ghost, shortlist.candidates.T_world_object)

    def show(self, visible: bool) -> None:
        self._root.show(visible)


def two_sigma_m(prediction: Prediction) -> Array | None:
    """(m, 3) closed line around the predicted way, two standard deviations off; None where it would be on the way."""
    reach_m = 2.0 * prediction.position_std_m
    if reach_m.max() < THINNEST_M:
        return None
    way_m = prediction.Ts_world_object[:, :3, 3]
    along = np.gradient(way_m[:, :2], axis=0)
    lengths = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(lengths > 1e-9, along / np.maximum(lengths, 1e-9), [1.0, 0.0])
    aside = reach_m[:, None] * np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    beyond = reach_m[-1] * np.array([[*along[-1], 0.0]])
    left_m, right_m = way_m + aside, way_m - aside
    return np.concatenate([left_m, left_m[-1:] + beyond, right_m[-1:] + beyond, right_m[::-1], left_m[:1]])


class PlansLayer:
    """Ways of the hand: the current plan, and the earlier one it was seeded with."""

    title = "Plans"
    swatches: tuple[tuple[Rgb, str], ...] = (
        (palette.PLAN, "Current plan"),
        (palette.SEED_PLAN, "Its seed"),
    )

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/plans")
        self._plan: Polyline | None = None
        self._seed: Polyline | None = None

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._seed = Polyline(self._scene, f"{self._root.name}/seed", palette.SEED_PLAN, 7.0)
        self._plan = Polyline(self._scene, f"{self._root.name}/plan", palette.PLAN, 3.5)

    def draw(self, picture: Picture) -> None:
        if not picture.new_cycle or self._plan is None or self._seed is None:
            return
        traces = picture.traces
        if traces is None or picture.cycle is None:
            self._plan.draw(None)
            self._seed.draw(None)
        elif traces.plan_m is not None:
            self._plan.draw(traces.plan_m)
            self._seed.draw(None if traces.seed_m is None else traces.seed_m - SEED_BELOW_M)

    def show(self, visible: bool) -> None:
        self._root.show(visible)


class TrailLayer:
    """Where the hand has been in the last seconds."""

    title = "Hand trail"
    swatches: tuple[tuple[Rgb, str], ...] = ((palette.TRAIL, "Hand trail"),)

    def __init__(self, scene: viser.SceneApi, touch: Touch, under: str = "") -> None:
        self._scene = scene
        self._root = Root(scene, under + "/trail")
        self._line: Polyline | None = None
        self._points: deque[tuple[float, Array]] = deque()
        self._drawn_s = 0.0

    def begin(self, scene: SceneDescription) -> None:
        self._root.clear()
        self._line = Polyline(self._scene, f"{self._root.name}/line", palette.TRAIL, 2.0)
        self._points.clear()
        self._drawn_s = -TRAIL_REDRAW_S

    def draw(self, picture: Picture) -> None:
        t_s = picture.snapshot.t_s
        if not self._points or t_s - self._points[-1][0] >= TRAIL_STEP_S:
            self._points.append((t_s, picture.snapshot.T_world_tcp.xyz_m))
        while self._points[-1][0] - self._points[0][0] > KEPT_S + TRAIL_S:
            self._points.popleft()
        if self._line is not None and abs(t_s - self._drawn_s) >= TRAIL_REDRAW_S:
            self._drawn_s = t_s
            recent = [point for at_s, point in self._points if 0.0 <= t_s - at_s <= TRAIL_S]
            self._line.draw(np.array(recent))

    def show(self, visible: bool) -> None:
        self._root.show(visible)
