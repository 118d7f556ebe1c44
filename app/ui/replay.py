"""Replay: the last minute of a trial as one HTML file that plays anywhere, without this server."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Sequence
from dataclasses import replace

from app.history import Moment
from app.reports import Started
from app.state import SessionState
from app.ui.camera import FIELD_OF_VIEW_RAD, beside_m, viewpoint
from app.ui.rooms import light
from app.ui.start import start_viser
from app.ui.touch import Untouched
from app.ui.worlds import Worlds
from app.view import SharedView

FRAME_S = 1 / 15
LONGEST_GAP_S = 1.0
"""Nothing is waited for longer than this: a minute that begins late in a trial begins at once."""


def replay_html(state: SessionState, started: Started, moments: Sequence[Moment]) -> str:
    """Play ``moments`` into a viser of its own that nobody watches, and keep what it would have sent."""
    server = start_viser()
    try:
        light(server.scene, low_fx=True)
        position, look_at = viewpoint(started.scene, beside_m(started))
        server.initial_camera.position, server.initial_camera.look_at = position, look_at
        server.initial_camera.fov = FIELD_OF_VIEW_RAD
        plain = replace(state, view=SharedView())
        worlds = Worlds(server.scene, Untouched())
        worlds.begin(started, plain.view)
        recording = server.get_scene_serializer()
        shown_s = -FRAME_S
        for moment in moments:
            elapsed_s = moment.t_s - shown_s
            if elapsed_s < 0.99 * FRAME_S:
                continue
            worlds.draw(replace(plain, looked_at=moment).shown)
            recording.insert_sleep(min(elapsed_s, LONGEST_GAP_S))
            shown_s = moment.t_s
        return recording.as_html()
    finally:
        with contextlib.redirect_stdout(io.StringIO()):
            server.stop()
