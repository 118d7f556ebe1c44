"""Replay: the last minute of a trial as one HTML file that plays anywhere, without this server."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Sequence
from dataclasses import replace

from app.history import Moment
from app.ui.camera import FIELD_OF_VIEW_RAD, viewpoint
from app.ui.layers import LAYERS, Layer, Picture
from app.ui.rooms import light
from app.ui.start import start_viser
from app.ui.touch import Untouched
from backend.snapshot import SceneDescription

FRAME_S = 1 / 15
LONGEST_GAP_S = 1.0
"""Nothing is waited for longer than this: a minute that begins late in a trial begins at once."""


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
        shown_s, cycle = -FRAME_S, None
        for moment in moments:
            elapsed_s = moment.snapshot.t_s - shown_s
            if elapsed_s < 0.99 * FRAME_S:
                continue
            picture = Picture(scene, moment.snapshot, moment.traces, new_cycle=True)
            if picture.cycle is cycle:
                picture = replace(picture, new_cycle=False)
            for layer in layers:
                layer.draw(picture)
            recording.insert_sleep(min(elapsed_s, LONGEST_GAP_S))
            shown_s, cycle = moment.snapshot.t_s, picture.cycle
        return recording.as_html()
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()
