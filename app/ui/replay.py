"""Replay: the last minute of a trial as one HTML file that plays anywhere, without this server."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Sequence

from app.history import Moment
from app.ui.camera import FIELD_OF_VIEW_RAD, viewpoint
from app.ui.layers import LAYERS, Layer, Picture
from app.ui.rooms import light
from app.ui.start import start_viser
from app.ui.touch import Untouched
from backend.snapshot import SceneDescription

FRAME_S = 1 / 15


def replay_html(scene: SceneDescription, moments: Sequence[Moment]) -> str:
    """Play ``moments`` into a viser of its own that nobody watches, and keep what it would have sent."""
    server = start_viser()
    try:
        light(server.scene, low_fx=True)
        position, look_at = viewpoint(scene)
        server.initial_camera.position, server.initial_camera.look_at = position, look_at
        server.initial_camera.fov = FIELD_OF_VIEW_RAD
        layers: list[Layer] = [layer(server.scene, Untouched()) for layer in LAYERS]
        for layer in layers:
            layer.begin(scene)
        recording = server.get_scene_serializer()
        before: Moment | None = None
        for moment in moments:
            elapsed_s = moment.snapshot.t_s - before.snapshot.t_s if before else FRAME_S
            if elapsed_s < 0.99 * FRAME_S:
                continue
            new_cycle = before is None or moment.snapshot.cycle is not before.snapshot.cycle
            for layer in layers:
                layer.draw(Picture(scene, moment.snapshot, moment.traces, new_cycle))
            recording.insert_sleep(elapsed_s)
            before = moment
        return recording.as_html()
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()
