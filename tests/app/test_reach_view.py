"""What is drawn of reach and of how sure a prediction is, against closed forms; and the switches for it."""

from typing import Any

import numpy as np
import pytest
import viser

from app.commands import Restart
from app.ui.layers import Picture
from app.ui.layers.paths import two_sigma_m
from app.ui.layers.reach import ReachLayer, slice_image
from app.ui.touch import Untouched
from app.view import SharedView
from backend.knowledge.reach_profile import GraspKind
from backend.pipeline.values import Prediction
from backend.snapshot import SceneDescription, Snapshot
from tests.app.fake_episode import FakeEngine

ENGINE = FakeEngine()


@pytest.fixture(scope="module")
def start() -> tuple[SceneDescription, Snapshot]:
    episode = ENGINE.make_episode(Restart(scenario="ur5_linear_slab", overrides={}))
    return episode.scene, next(iter(episode.run()))


def test_the_slice_of_reach_is_as_wide_as_the_profile_says():
    reach = ENGINE.reach("mico")
    shapes: tuple[tuple[GraspKind, float], ...] = (("From above", 0.8), ("From the side", 0.6))
    for kind, radius_m in shapes:
        for height_m in (0.0, 0.3):
            seen = slice_image(reach, kind, height_m)[..., 3] > 0
            area_m2 = seen.mean() * (2.0 * reach.radius_m[-1]) ** 2
            assert area_m2 == pytest.approx(np.pi * (radius_m**2 - height_m**2), rel=0.06)
    assert not slice_image(reach, "From the side", 0.88)[..., 3].any()


def test_the_slice_of_reach_is_drawn_when_it_is_shown_and_follows_the_view(
    server: viser.ViserServer, start: tuple[SceneDescription, Snapshot]
):
    scene, snapshot = start
    layer = ReachLayer(server.scene, Untouched(), "/reaching")
    layer.begin(scene)

    def draw(view: SharedView) -> Any:
        layer.show("Reach" not in view.hidden)
        layer.draw(Picture(scene, snapshot, None, False, ENGINE.reach("mico"), view))
        return server.scene.get_handle_by_name("/reaching/reach/slice")

    assert draw(SharedView()) is None
    low = draw(SharedView(hidden=(), reach_height_m=0.1)).image.copy()
    image = draw(SharedView(hidden=(), reach_height_m=0.5))
    assert image.position[2] == 0.5
    assert (image.image[..., 3] > 0).sum() < (low[..., 3] > 0).sum()


def test_bounds_lie_two_sigma_off_the_way():
    Ts = np.tile(np.eye(4), (3, 1, 1))
    Ts[:, 0, 3] = [0.0, 0.1, 0.2]
    prediction = Prediction(np.arange(3.0), Ts, np.array([0.0, 0.01, 0.02]), np.zeros(3))
    line_m = two_sigma_m(prediction)
    assert line_m is not None
    np.testing.assert_allclose(line_m[:3, 1], [0.0, 0.02, 0.04])
    np.testing.assert_allclose(np.sort(line_m[:, 1]), np.sort(-line_m[:, 1]))
    assert line_m[:, 0].max() == pytest.approx(0.24)
    np.testing.assert_array_equal(line_m[0], line_m[-1])
    assert two_sigma_m(Prediction(np.arange(3.0), Ts, np.zeros(3), np.zeros(3))) is None
    still = Prediction(np.arange(3.0), np.tile(np.eye(4), (3, 1, 1)), np.full(3, 0.01), np.zeros(3))
    line_m = two_sigma_m(still)
    assert line_m is not None and np.isfinite(line_m).all()
